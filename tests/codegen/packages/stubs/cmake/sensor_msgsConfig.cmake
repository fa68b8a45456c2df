include("${CMAKE_CURRENT_LIST_DIR}/stub.cmake")
stub(sensor_msgs::sensor_msgs)
set(sensor_msgs_TARGETS sensor_msgs::sensor_msgs)
