// What the controller uses of rclcpp (Kilted). Messages and lines of the log are kept, so that a test can read them.
#ifndef STUB_RCLCPP_HPP
#define STUB_RCLCPP_HPP

#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "builtin_interfaces/msg/time.hpp"
#include "rcl_interfaces/msg/set_parameters_result.hpp"

namespace rclcpp {

class Time {
public:
    explicit Time(std::int64_t nanoseconds) : nanoseconds_(nanoseconds) {}
    std::int64_t nanoseconds() const { return nanoseconds_; }
    operator builtin_interfaces::msg::Time() const
    {
        builtin_interfaces::msg::Time time;
        time.sec = static_cast<std::int32_t>(nanoseconds_ / 1000000000);
        time.nanosec = static_cast<std::uint32_t>(nanoseconds_ % 1000000000);
        return time;
    }

private:
    std::int64_t nanoseconds_;
};

class Duration {
public:
    explicit Duration(std::int64_t nanoseconds) : nanoseconds_(nanoseconds) {}
    std::int64_t nanoseconds() const { return nanoseconds_; }

private:
    std::int64_t nanoseconds_;
};

class Clock {
public:
    using SharedPtr = std::shared_ptr<Clock>;
};

class Logger {};

__attribute__((format(printf, 1, 2))) inline void stub_log(const char *format, ...)
{
    std::va_list words;
    va_start(words, format);
    std::printf("log ");
    std::vprintf(format, words);
    std::printf("\n");
    va_end(words);
}

#define RCLCPP_WARN(logger, ...) (static_cast<void>(logger), rclcpp::stub_log(__VA_ARGS__))
#define RCLCPP_ERROR(logger, ...) (static_cast<void>(logger), rclcpp::stub_log(__VA_ARGS__))
#define RCLCPP_WARN_THROTTLE(logger, clock, duration, ...) \
    (static_cast<void>(logger), static_cast<void>(clock), static_cast<void>(duration), rclcpp::stub_log(__VA_ARGS__))

using ParameterValue = std::variant<bool, double, std::string, std::vector<double>, std::vector<std::string>>;

class Parameter {
public:
    Parameter(const std::string &name, ParameterValue value) : name_(name), value_(std::move(value)) {}
    const std::string &get_name() const { return name_; }
    bool as_bool() const { return std::get<bool>(value_); }
    double as_double() const { return std::get<double>(value_); }
    const std::string &as_string() const { return std::get<std::string>(value_); }
    const std::vector<double> &as_double_array() const { return std::get<std::vector<double>>(value_); }
    const std::vector<std::string> &as_string_array() const { return std::get<std::vector<std::string>>(value_); }
    const ParameterValue &stub_value() const { return value_; }

private:
    std::string name_;
    ParameterValue value_;
};

class QoS {};
class SystemDefaultsQoS : public QoS {};

template <typename Message> class Publisher {
public:
    using SharedPtr = std::shared_ptr<Publisher>;
    virtual ~Publisher() = default;
    virtual void publish(const Message &message) { stub_last = std::make_shared<Message>(message); }
    std::shared_ptr<Message> stub_last;
};

template <typename Message> class Subscription {
public:
    using SharedPtr = std::shared_ptr<Subscription>;
    std::function<void(std::shared_ptr<Message>)> stub_callback;
};

namespace node_interfaces {
struct OnSetParametersCallbackHandle {
    using SharedPtr = std::shared_ptr<OnSetParametersCallbackHandle>;
    std::function<rcl_interfaces::msg::SetParametersResult(const std::vector<Parameter> &)> callback;
};
} // namespace node_interfaces

} // namespace rclcpp

#endif
