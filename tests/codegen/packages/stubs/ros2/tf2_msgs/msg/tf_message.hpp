// What the controller uses of tf2_msgs, which has no wheel on PyPI.
#ifndef STUB_TF_MESSAGE_HPP
#define STUB_TF_MESSAGE_HPP

#include <vector>

#include "geometry_msgs/msg/transform_stamped.hpp"

namespace tf2_msgs::msg {
struct TFMessage {
    std::vector<geometry_msgs::msg::TransformStamped> transforms;
};
} // namespace tf2_msgs::msg

#endif
