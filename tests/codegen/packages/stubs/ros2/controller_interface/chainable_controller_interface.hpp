// What the controller uses of controller_interface (Jazzy, Kilted and Rolling).
#ifndef STUB_CHAINABLE_CONTROLLER_INTERFACE_HPP
#define STUB_CHAINABLE_CONTROLLER_INTERFACE_HPP

#include "hardware_interface/handle.hpp"
#include "rclcpp_lifecycle/lifecycle_node.hpp"

namespace controller_interface {

using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;

enum class return_type : std::uint8_t { OK = 0, ERROR = 1 };
enum class interface_configuration_type : std::uint8_t { ALL = 0, INDIVIDUAL = 1, NONE = 2 };

struct InterfaceConfiguration {
    interface_configuration_type type = interface_configuration_type::NONE;
    std::vector<std::string> names = {};
};

class ControllerInterfaceBase : public rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface {
public:
    virtual InterfaceConfiguration command_interface_configuration() const = 0;
    virtual InterfaceConfiguration state_interface_configuration() const = 0;
    virtual void assign_interfaces(std::vector<hardware_interface::LoanedCommandInterface> &&command_interfaces,
                                   std::vector<hardware_interface::LoanedStateInterface> &&state_interfaces)
    {
        command_interfaces_ = std::move(command_interfaces);
        state_interfaces_ = std::move(state_interfaces);
    }
    virtual CallbackReturn on_init() = 0;
    virtual return_type update(const rclcpp::Time &time, const rclcpp::Duration &period) = 0;
    std::shared_ptr<rclcpp_lifecycle::LifecycleNode> get_node() { return node_; }
    std::shared_ptr<const rclcpp_lifecycle::LifecycleNode> get_node() const { return node_; }
    template <typename Value> auto auto_declare(const std::string &name, const Value &default_value)
    {
        return get_node()->has_parameter(name) ? Value() : get_node()->declare_parameter<Value>(name, default_value);
    }

protected:
    std::vector<hardware_interface::LoanedCommandInterface> command_interfaces_;
    std::vector<hardware_interface::LoanedStateInterface> state_interfaces_;

private:
    std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node_ = std::make_shared<rclcpp_lifecycle::LifecycleNode>();
};

class ChainableControllerInterface : public ControllerInterfaceBase {
public:
    return_type update(const rclcpp::Time &time, const rclcpp::Duration &period) final
    {
        const return_type reference =
            is_in_chained_mode() ? return_type::OK : update_reference_from_subscribers(time, period);
        return reference == return_type::OK ? update_and_write_commands(time, period) : reference;
    }
    std::vector<hardware_interface::CommandInterface::SharedPtr> export_reference_interfaces()
    {
        ordered_exported_reference_interfaces_ = on_export_reference_interfaces_list();
        return ordered_exported_reference_interfaces_;
    }
    bool set_chained_mode(bool chained_mode)
    {
        in_chained_mode_ = on_set_chained_mode(chained_mode) && chained_mode;
        return true;
    }
    bool is_in_chained_mode() const { return in_chained_mode_; }

protected:
    virtual std::vector<hardware_interface::CommandInterface::SharedPtr> on_export_reference_interfaces_list() { return {}; }
    virtual bool on_set_chained_mode(bool chained_mode) { return static_cast<void>(chained_mode), true; }
    virtual return_type update_reference_from_subscribers(const rclcpp::Time &time, const rclcpp::Duration &period) = 0;
    virtual return_type update_and_write_commands(const rclcpp::Time &time, const rclcpp::Duration &period) = 0;

    std::vector<hardware_interface::CommandInterface::SharedPtr> ordered_exported_reference_interfaces_;

private:
    bool in_chained_mode_ = false;
};

} // namespace controller_interface

#endif
