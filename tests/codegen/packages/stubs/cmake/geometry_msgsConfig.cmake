include("${CMAKE_CURRENT_LIST_DIR}/stub.cmake")
stub(geometry_msgs::geometry_msgs)
set(geometry_msgs_TARGETS geometry_msgs::geometry_msgs)
