# Builds the interfaces of a package: those in it, in its folder `both`, and in the folder that is
# called as the distribution.
foreach(dependency ${dependencies} ament_cmake rosidl_default_generators)
  find_package(${dependency} REQUIRED)
endforeach()
foreach(part . both $ENV{ROS_DISTRO})
  set(folder ${CMAKE_CURRENT_SOURCE_DIR}/${part})
  file(GLOB files RELATIVE ${folder} ${folder}/action/*.action ${folder}/msg/*.msg ${folder}/srv/*.srv)
  list(TRANSFORM files PREPEND ${folder}:)
  list(APPEND interfaces ${files})
endforeach()
rosidl_generate_interfaces(${PROJECT_NAME} ${interfaces} DEPENDENCIES ${dependencies})
ament_export_dependencies(rosidl_default_runtime)
ament_package()
