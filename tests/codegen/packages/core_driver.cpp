// Reads steps for a core from the input, one a line, and prints what the core returns. Times are nanoseconds.
//
// joints TIME VALUE...          a value for each joint; `-` if the joint did not come
// command TIME VX VY OMEGA
// act TIME
// alive TIME
// restart
// set NAME VALUE...             a setting
// text                          the lines of the events so far
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <sstream>

#include CORE

using namespace ROBOT;

namespace {

Core core;
Settings settings;
std::vector<Event> events;

double read(std::istream &line)
{
    std::string word;
    line >> word;
    return std::strtod(word.c_str(), nullptr);
}

void joints_came(std::istream &line, Nanoseconds now)
{
    Core::Measured measured;
    for (std::optional<double> &value : measured) {
        std::string word;
        line >> word;
        if (word != "-") {
            value = std::strtod(word.c_str(), nullptr);
        }
    }
    if (const std::optional<Odometry> got = core.joint_states(measured, now)) {
        std::printf("odometry %lld %.17g %.17g %.17g %.17g %.17g %.17g", static_cast<long long>(got->stamp), got->x, got->y,
                    got->theta, got->twist.vx, got->twist.vy, got->twist.omega);
        for (const auto *matrix : { &got->pose_covariance, &got->twist_covariance }) {
            for (const double value : *matrix) {
                std::printf(" %.17g", value);
            }
        }
        std::printf("\n");
    }
}

void set(std::istream &line)
{
    std::string name;
    line >> name;
    if (name == "cmd_timeout") {
        settings.cmd_timeout = read(line);
    } else if (name == "joint_timeout") {
        settings.joint_timeout = read(line);
    } else if (name == "long_step") {
        settings.long_step = read(line);
    } else if (name == "longest_step") {
        settings.longest_step = read(line);
    } else if (name == "limit.vx") {
        settings.limits[0].low = read(line);
        settings.limits[0].high = read(line);
    } else {
        for (std::size_t k = 0; k < tunables.size(); ++k) {
            if (name == tunables[k].name) {
                settings.tunable[k] = read(line);
            }
        }
    }
    std::printf("configured %d\n", core.configure(settings) ? 1 : 0);
}

} // namespace

int main()
{
    for (std::string text; std::getline(std::cin, text);) {
        std::istringstream line(text);
        std::string verb;
        line >> verb;
        Nanoseconds now = 0;
        if (verb == "joints" || verb == "command" || verb == "act" || verb == "alive") {
            line >> now;
        }
        if (verb == "joints") {
            joints_came(line, now);
        } else if (verb == "command") {
            Twist twist;
            twist.vx = read(line);
            twist.vy = read(line);
            twist.omega = read(line);
            core.command(twist, now);
        } else if (verb == "act") {
            std::printf("commands");
            for (const double value : core.joint_commands(now)) {
                std::printf(" %.17g", value);
            }
            std::printf("\n");
        } else if (verb == "alive") {
            std::printf("alive %d %d\n", core.alive(now) ? 1 : 0, core.started() ? 1 : 0);
        } else if (verb == "restart") {
            core.restart();
        } else if (verb == "set") {
            set(line);
        }
        while (const std::optional<Event> event = core.next_event()) {
            std::printf("event %s\n", core.text(*event).c_str());
        }
        std::printf("end\n");
    }
}
