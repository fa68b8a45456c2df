// A stand-in for rclcpp, as much of it as the generated node uses: spin() reads events from standard input,
// "clock T", "cmd_vel VX VY OMEGA", "joint_states T NAME VELOCITY POSITION ..."; what is published is printed.
#pragma once
#include <cstdint>
#include <cstdio>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <utility>

#include <builtin_interfaces/msg/time.hpp>
#include <geometry_msgs/msg/twist.hpp>
#include <sensor_msgs/msg/joint_state.hpp>

namespace rclcpp {

inline double clock_seconds = 0;
inline std::map<std::string, std::function<void(const void *)>> subscribed;

class Duration {
public:
    explicit Duration(std::int64_t nanoseconds) : nanoseconds_(nanoseconds) {}
    double seconds() const { return 1e-9 * static_cast<double>(nanoseconds_); }

private:
    std::int64_t nanoseconds_;
};

class Time {
public:
    Time(const builtin_interfaces::msg::Time &time) : nanoseconds_(time.sec * 1000000000LL + time.nanosec) {}
    Duration operator-(const Time &other) const { return Duration(nanoseconds_ - other.nanoseconds_); }
    operator builtin_interfaces::msg::Time() const
    {
        return {static_cast<std::int32_t>(nanoseconds_ / 1000000000LL),
                static_cast<std::uint32_t>(nanoseconds_ % 1000000000LL)};
    }

private:
    std::int64_t nanoseconds_;
};

inline Time time_of(double seconds)
{
    const auto all = static_cast<std::int64_t>(seconds * 1e9 + 0.5);
    return Time({static_cast<std::int32_t>(all / 1000000000LL), static_cast<std::uint32_t>(all % 1000000000LL)});
}

class Clock {};
struct Logger {};
struct QoS {
    QoS(std::size_t) {}
};
struct SensorDataQoS : QoS {
    SensorDataQoS() : QoS(5) {}
};

template <typename Message> class Publisher {
public:
    using SharedPtr = std::shared_ptr<Publisher>;
    void publish(const Message &message) { print(message); }
};

template <typename Message> class Subscription {
public:
    using SharedPtr = std::shared_ptr<Subscription>;
};

class Node {
public:
    explicit Node(const std::string &) {}
    virtual ~Node() = default;

    template <typename T> T declare_parameter(const std::string &, const T &value) { return value; }
    template <typename Message> std::shared_ptr<Publisher<Message>> create_publisher(const std::string &, const QoS &)
    {
        return std::make_shared<Publisher<Message>>();
    }
    template <typename Message, typename Callback>
    std::shared_ptr<Subscription<Message>> create_subscription(const std::string &topic, const QoS &, Callback callback)
    {
        subscribed[topic] = [callback](const void *message) { callback(*static_cast<const Message *>(message)); };
        return std::make_shared<Subscription<Message>>();
    }
    Logger get_logger() const { return {}; }
    std::shared_ptr<Clock> get_clock() { return std::make_shared<Clock>(); }
    Time now() const { return time_of(clock_seconds); }
};

inline void warn(const Logger &, const Clock &, const char *text)
{
    std::cout << "warning " << text << "\n";
}

inline void init(int, char **) {}
inline void shutdown() {}
inline void spin(const std::shared_ptr<Node> &)
{
    std::cout.precision(17);
    for (std::string line; std::getline(std::cin, line);) {
        std::istringstream words(line);
        std::string what;
        words >> what;
        if (what == "clock") {
            words >> clock_seconds;
        } else if (what == "cmd_vel") {
            geometry_msgs::msg::Twist twist;
            words >> twist.linear.x >> twist.linear.y >> twist.angular.z;
            subscribed.at(what)(&twist);
        } else {
            sensor_msgs::msg::JointState joints;
            double stamp = 0;
            words >> stamp;
            joints.header.stamp = time_of(stamp);
            std::string name, velocity, position; // by std::stod, which reads nan
            while (words >> name >> velocity >> position) {
                joints.name.push_back(name);
                joints.velocity.push_back(std::stod(velocity));
                joints.position.push_back(std::stod(position));
            }
            subscribed.at(what)(&joints);
        }
    }
}

} // namespace rclcpp

#define RCLCPP_WARN_THROTTLE(logger, clock, duration, text) rclcpp::warn(logger, clock, text)
