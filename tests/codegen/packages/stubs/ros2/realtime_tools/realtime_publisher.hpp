// What the controller uses of realtime_tools (Jazzy, Kilted and Rolling).
#ifndef STUB_REALTIME_PUBLISHER_HPP
#define STUB_REALTIME_PUBLISHER_HPP

#include "rclcpp/rclcpp.hpp"

namespace realtime_tools {

template <class Message> class RealtimePublisher {
public:
    explicit RealtimePublisher(typename rclcpp::Publisher<Message>::SharedPtr publisher) : publisher_(publisher) {}
    bool try_publish(const Message &message)
    {
        publisher_->publish(message);
        return true;
    }

private:
    RealtimePublisher(const RealtimePublisher &) = delete;
    RealtimePublisher &operator=(const RealtimePublisher &) = delete;
    typename rclcpp::Publisher<Message>::SharedPtr publisher_;
};

} // namespace realtime_tools

#endif
