#pragma once
#include <iostream>
#include <string>
#include <vector>

#include <std_msgs/msg/header.hpp>
namespace sensor_msgs::msg {
struct JointState {
    std_msgs::msg::Header header;
    std::vector<std::string> name;
    std::vector<double> position, velocity, effort;
};
inline void print(const JointState &message)
{
    std::cout << "joint_commands";
    for (std::size_t i = 0; i < message.name.size(); ++i) {
        std::cout << " " << message.name[i] << " " << message.velocity.at(i) << " " << message.position.at(i);
    }
    std::cout << "\n";
}
} // namespace sensor_msgs::msg
