include("${CMAKE_CURRENT_LIST_DIR}/stub.cmake")
stub(nav_msgs::nav_msgs)
set(nav_msgs_TARGETS nav_msgs::nav_msgs)
