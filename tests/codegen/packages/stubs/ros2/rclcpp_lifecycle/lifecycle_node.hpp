// What the controller uses of rclcpp_lifecycle (Kilted).
#ifndef STUB_RCLCPP_LIFECYCLE_NODE_HPP
#define STUB_RCLCPP_LIFECYCLE_NODE_HPP

#include "rclcpp/rclcpp.hpp"
#include "rclcpp_lifecycle/state.hpp"

namespace rclcpp_lifecycle {

template <typename Message> class LifecyclePublisher : public rclcpp::Publisher<Message> {};

namespace node_interfaces {
class LifecycleNodeInterface {
public:
    enum class CallbackReturn : std::uint8_t { SUCCESS = 97, FAILURE = 98, ERROR = 99 };
    virtual ~LifecycleNodeInterface() = default;
    virtual CallbackReturn on_configure(const State &) { return CallbackReturn::SUCCESS; }
    virtual CallbackReturn on_activate(const State &) { return CallbackReturn::SUCCESS; }
    virtual CallbackReturn on_deactivate(const State &) { return CallbackReturn::SUCCESS; }
};
} // namespace node_interfaces

class LifecycleNode {
public:
    const char *get_name() const { return "wheels"; }
    rclcpp::Logger get_logger() const { return {}; }
    rclcpp::Clock::SharedPtr get_clock() { return std::make_shared<rclcpp::Clock>(); }

    bool has_parameter(const std::string &name) const { return stub_parameters.count(name) > 0; }
    rclcpp::Parameter get_parameter(const std::string &name) const
    {
        return rclcpp::Parameter(name, stub_parameters.at(name));
    }
    template <typename Value> Value declare_parameter(const std::string &name, const Value &value)
    {
        stub_parameters.emplace(name, value);
        return value;
    }
    [[nodiscard]] rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr add_on_set_parameters_callback(
        std::function<rcl_interfaces::msg::SetParametersResult(const std::vector<rclcpp::Parameter> &)> callback)
    {
        auto handle = std::make_shared<rclcpp::node_interfaces::OnSetParametersCallbackHandle>();
        handle->callback = std::move(callback);
        stub_on_parameters = handle;
        return handle;
    }
    template <typename Message>
    std::shared_ptr<LifecyclePublisher<Message>> create_publisher(const std::string &topic, const rclcpp::QoS &)
    {
        auto made = std::make_shared<LifecyclePublisher<Message>>();
        stub_publishers[topic] = made;
        return made;
    }
    template <typename Message, typename Callback>
    std::shared_ptr<rclcpp::Subscription<Message>> create_subscription(const std::string &topic, const rclcpp::QoS &,
                                                                       Callback &&callback)
    {
        auto made = std::make_shared<rclcpp::Subscription<Message>>();
        made->stub_callback = callback;
        stub_subscriptions[topic] = made;
        return made;
    }

    std::map<std::string, rclcpp::ParameterValue> stub_parameters;
    std::map<std::string, std::shared_ptr<void>> stub_publishers;
    std::map<std::string, std::shared_ptr<void>> stub_subscriptions;
    std::weak_ptr<rclcpp::node_interfaces::OnSetParametersCallbackHandle> stub_on_parameters;
};

} // namespace rclcpp_lifecycle

#endif
