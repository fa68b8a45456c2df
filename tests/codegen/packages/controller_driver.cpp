// A stand-in for the controller manager: it reads steps for a controller from the input, one a line, and prints what the
// controller does. Times are nanoseconds. `log` lines are those of the controller.
//
// parameter NAME number|text|flag|texts VALUE...   before configure
// init | configure | activate | deactivate         the lifecycle; prints the result
// hardware NAME...                                 the interfaces that the hardware has; all that are asked for if not given
// state NAME VALUE                                 a state of the hardware; `-` while another thread has the lock
// chain 0|1                                        whether another controller precedes this one
// cmd_vel VX VY OMEGA | reference VX VY OMEGA
// set NAME VALUE                                   a parameter while the controller runs
// update TIME
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <sstream>

#include CONTROLLER

using namespace ROBOT;
using geometry_msgs::msg::TwistStamped;
using tf2_msgs::msg::TFMessage;

namespace {

Controller controller;
std::vector<std::string> hardware;
std::vector<hardware_interface::CommandInterface::SharedPtr> commands;
std::vector<std::shared_ptr<hardware_interface::StateInterface>> states;
std::vector<hardware_interface::CommandInterface::SharedPtr> references;

double read(std::istream &line)
{
    std::string word;
    line >> word;
    return std::strtod(word.c_str(), nullptr);
}

bool has(const std::string &name)
{
    return hardware.empty() || std::find(hardware.begin(), hardware.end(), name) != hardware.end();
}

template <typename Interface> auto made(const std::vector<std::string> &names, const char *what)
{
    std::vector<std::shared_ptr<Interface>> result;
    std::printf("%s", what);
    for (const std::string &name : names) {
        const auto slash = name.rfind('/');
        std::printf(" %s", name.c_str());
        if (has(name)) {
            result.push_back(std::make_shared<Interface>(name.substr(0, slash), name.substr(slash + 1)));
        }
    }
    std::printf("\n");
    return result;
}

void activate()
{
    using hardware_interface::CommandInterface;
    using hardware_interface::StateInterface;

    commands = made<CommandInterface>(controller.command_interface_configuration().names, "commands");
    states = made<StateInterface>(controller.state_interface_configuration().names, "states");
    references = controller.export_reference_interfaces();
    for (const auto &reference : references) {
        std::printf("reference %s\n", reference->get_name().c_str());
    }
    std::vector<hardware_interface::LoanedCommandInterface> loaned_commands(commands.begin(), commands.end());
    std::vector<hardware_interface::LoanedStateInterface> loaned_states(states.begin(), states.end());
    controller.assign_interfaces(std::move(loaned_commands), std::move(loaned_states));
    std::printf("result %d\n", static_cast<int>(controller.on_activate({})));
}

template <typename Message> std::shared_ptr<Message> published(const std::string &topic)
{
    const auto found = std::static_pointer_cast<rclcpp_lifecycle::LifecyclePublisher<Message>>(
        controller.get_node()->stub_publishers.at(topic));
    return std::exchange(found->stub_last, nullptr);
}

void update(std::istream &line)
{
    std::int64_t now = 0;
    line >> now;
    const auto done = controller.update(rclcpp::Time(now), rclcpp::Duration(0));
    std::printf("updated %d\n", static_cast<int>(done));
    for (const auto &command : commands) {
        std::printf("command %s %.17g\n", command->get_name().c_str(), command->stub_value.value_or(std::nan("")));
    }
    if (const auto got = published<nav_msgs::msg::Odometry>("~/odom")) {
        std::printf("odometry %s %s %d %u %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", got->header.frame_id.c_str(),
                    got->child_frame_id.c_str(), got->header.stamp.sec, got->header.stamp.nanosec, got->pose.pose.position.x,
                    got->pose.pose.position.y,
                    2.0 * std::atan2(got->pose.pose.orientation.z, got->pose.pose.orientation.w), got->twist.twist.linear.x,
                    got->twist.twist.linear.y, got->twist.twist.angular.z, got->pose.covariance[0],
                    got->twist.covariance[35]);
    }
    if (const auto got = published<TFMessage>("/tf")) {
        const auto &transform = got->transforms.at(0);
        std::printf("transform %s %s %d %u %.17g %.17g %.17g\n", transform.header.frame_id.c_str(),
                    transform.child_frame_id.c_str(), transform.header.stamp.sec, transform.header.stamp.nanosec,
                    transform.transform.translation.x, transform.transform.translation.y,
                    2.0 * std::atan2(transform.transform.rotation.z, transform.transform.rotation.w));
    }
}

void set_state(std::istream &line)
{
    std::string name, word;
    line >> name >> word;
    for (const auto &state : states) {
        if (state->get_name() == name) {
            state->stub_value = word == "-" ? std::optional<double>() : std::strtod(word.c_str(), nullptr);
        }
    }
}

void parameter(std::istream &line)
{
    std::string name, kind, word;
    line >> name >> kind;
    auto &parameters = controller.get_node()->stub_parameters;
    if (kind == "number") {
        parameters[name] = read(line);
    } else if (kind == "texts") {
        std::vector<std::string> words;
        while (line >> word) {
            words.push_back(word);
        }
        parameters[name] = words;
    } else {
        line >> word;
        if (kind == "flag") {
            parameters[name] = word == "true";
        } else {
            parameters[name] = word;
        }
    }
}

void set_running(std::istream &line)
{
    std::string name;
    line >> name;
    const double value = read(line);
    const auto handle = controller.get_node()->stub_on_parameters.lock();
    const auto result = handle->callback({ rclcpp::Parameter(name, value) });
    if (result.successful) {
        controller.get_node()->stub_parameters[name] = value;
    }
    std::printf("set %d\n", result.successful ? 1 : 0);
}

void command(std::istream &line)
{
    auto message = std::make_shared<TwistStamped>();
    message->twist.linear.x = read(line);
    message->twist.linear.y = read(line);
    message->twist.angular.z = read(line);
    std::static_pointer_cast<rclcpp::Subscription<TwistStamped>>(
        controller.get_node()->stub_subscriptions.at("~/cmd_vel"))->stub_callback(message);
}

} // namespace

int main()
{
    for (std::string text; std::getline(std::cin, text);) {
        std::istringstream line(text);
        std::string verb;
        line >> verb;
        if (verb == "init") {
            std::printf("result %d\n", static_cast<int>(controller.on_init()));
        } else if (verb == "configure") {
            std::printf("result %d\n", static_cast<int>(controller.on_configure({})));
        } else if (verb == "activate") {
            activate();
        } else if (verb == "deactivate") {
            std::printf("result %d\n", static_cast<int>(controller.on_deactivate({})));
            for (const auto &motor : commands) {
                std::printf("command %s %.17g\n", motor->get_name().c_str(), motor->stub_value.value_or(std::nan("")));
            }
        } else if (verb == "hardware") {
            for (std::string name; line >> name;) {
                hardware.push_back(name);
            }
        } else if (verb == "chain") {
            controller.set_chained_mode(read(line) > 0.0);
        } else if (verb == "reference") {
            for (const auto &reference : references) {
                static_cast<void>(reference->set_value(read(line)));
            }
        } else if (verb == "cmd_vel") {
            command(line);
        } else if (verb == "parameter") {
            parameter(line);
        } else if (verb == "set") {
            set_running(line);
        } else if (verb == "state") {
            set_state(line);
        } else if (verb == "update") {
            update(line);
        }
        std::printf("end\n");
    }
}
