# Stand-ins for what `find_package` brings of ROS 2: targets with the stub headers, and the functions of ament.
get_filename_component(STUBS "${CMAKE_CURRENT_LIST_DIR}/../include" ABSOLUTE)
function(stub target)
  if(NOT TARGET ${target})
    add_library(${target} INTERFACE IMPORTED)
    target_include_directories(${target} INTERFACE "${STUBS}")
  endif()
endfunction()
