// What the controller uses of rclcpp_lifecycle (Kilted).
#ifndef STUB_RCLCPP_LIFECYCLE_STATE_HPP
#define STUB_RCLCPP_LIFECYCLE_STATE_HPP

namespace rclcpp_lifecycle {
class State {};
} // namespace rclcpp_lifecycle

#endif
