#pragma once
#include <array>
#include <iostream>
#include <string>

#include <geometry_msgs/msg/twist.hpp>
#include <std_msgs/msg/header.hpp>
namespace geometry_msgs::msg {
struct Point {
    double x = 0, y = 0, z = 0;
};
struct Quaternion {
    double x = 0, y = 0, z = 0, w = 1;
};
struct Pose {
    Point position;
    Quaternion orientation;
};
struct PoseWithCovariance {
    Pose pose;
    std::array<double, 36> covariance{};
};
struct TwistWithCovariance {
    Twist twist;
    std::array<double, 36> covariance{};
};
} // namespace geometry_msgs::msg
namespace nav_msgs::msg {
struct Odometry {
    std_msgs::msg::Header header;
    std::string child_frame_id;
    geometry_msgs::msg::PoseWithCovariance pose;
    geometry_msgs::msg::TwistWithCovariance twist;
};
inline void print(const Odometry &message)
{
    const auto &[position, turn] = message.pose.pose;
    const auto &[linear, angular] = message.twist.twist;
    std::cout << "odom " << position.x << " " << position.y << " " << turn.z << " " << turn.w << " " << linear.x << " "
              << linear.y << " " << angular.z;
    for (const double value : message.pose.covariance) {
        std::cout << " " << value;
    }
    for (const double value : message.twist.covariance) {
        std::cout << " " << value;
    }
    std::cout << "\n";
}
} // namespace nav_msgs::msg
