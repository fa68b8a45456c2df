include("${CMAKE_CURRENT_LIST_DIR}/stub.cmake")
stub(rclcpp::rclcpp)
set(rclcpp_TARGETS rclcpp::rclcpp)
