// What the controller uses of hardware_interface (Jazzy, Kilted and Rolling).
#ifndef STUB_HARDWARE_INTERFACE_HANDLE_HPP
#define STUB_HARDWARE_INTERFACE_HANDLE_HPP

#include <memory>
#include <optional>
#include <string>

namespace hardware_interface {

class Handle {
public:
    explicit Handle(const std::string &prefix_name, const std::string &interface_name,
                    const std::string &data_type = "double", const std::string &initial_value = "")
        : name_(prefix_name + "/" + interface_name)
    {
        (void)data_type;
        (void)initial_value;
    }
    const std::string &get_name() const { return name_; }
    template <typename Value = double> [[nodiscard]] std::optional<Value> get_optional() const { return stub_value; }
    template <typename Value> [[nodiscard]] bool set_value(const Value &value)
    {
        stub_value = value;
        return true;
    }
    std::optional<double> stub_value; // nothing: another thread has the lock

private:
    std::string name_;
};

class StateInterface : public Handle {
public:
    using Handle::Handle;
    using ConstSharedPtr = std::shared_ptr<const StateInterface>;
};

class CommandInterface : public Handle {
public:
    using Handle::Handle;
    CommandInterface(const CommandInterface &other) = delete;
    CommandInterface(CommandInterface &&other) = default;
    using SharedPtr = std::shared_ptr<CommandInterface>;
};

class LoanedStateInterface {
public:
    explicit LoanedStateInterface(StateInterface::ConstSharedPtr of) : of_(of) {}
    LoanedStateInterface(const LoanedStateInterface &other) = delete;
    LoanedStateInterface(LoanedStateInterface &&other) = default;
    const std::string &get_name() const { return of_->get_name(); }
    template <typename Value = double> [[nodiscard]] std::optional<Value> get_optional(unsigned int max_tries = 10) const
    {
        (void)max_tries;
        return of_->get_optional<Value>();
    }

private:
    StateInterface::ConstSharedPtr of_;
};

class LoanedCommandInterface {
public:
    explicit LoanedCommandInterface(CommandInterface::SharedPtr of) : of_(of) {}
    LoanedCommandInterface(const LoanedCommandInterface &other) = delete;
    LoanedCommandInterface(LoanedCommandInterface &&other) = default;
    const std::string &get_name() const { return of_->get_name(); }
    template <typename Value> [[nodiscard]] bool set_value(const Value &value, unsigned int max_tries = 10)
    {
        (void)max_tries;
        return of_->set_value(value);
    }

private:
    CommandInterface::SharedPtr of_;
};

} // namespace hardware_interface

#endif
