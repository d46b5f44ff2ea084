# Local SLAM (MRPT) and navigation; included by CMakeLists.txt.
find_package(mrpt-maps REQUIRED)
find_package(Eigen3 REQUIRED)
find_package(Ceres REQUIRED)

pybind11_add_module(_slam
  src/cpp/slam/bindings.cpp
  src/cpp/slam/grid_map.cpp src/cpp/slam/odometry_model.cpp
  src/cpp/slam/memory.cpp
  src/cpp/slam/pose_graph.cpp
  src/cpp/slam/scan.cpp
  src/cpp/slam/scan_matcher.cpp
  src/cpp/slam/slam.cpp
  src/cpp/slam/small_objects.cpp
  src/cpp/slam/standing.cpp)
target_link_libraries(_slam PRIVATE mrpt::maps Eigen3::Eigen Ceres::ceres)
target_compile_options(_slam PRIVATE -Wall -Wextra -Werror -O3)
set_target_properties(_slam PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${MR_SIM_PYTHON_DEVEL})
install(TARGETS _slam DESTINATION ${MR_SIM_PYTHON_INSTALL})

pybind11_add_module(_navigation
  src/cpp/navigation/bindings.cpp
  src/cpp/navigation/manoeuvre.cpp
  src/cpp/navigation/march.cpp
  src/cpp/navigation/rollout.cpp
  src/cpp/navigation/slowness.cpp
  src/cpp/navigation/surroundings.cpp)
target_compile_options(_navigation PRIVATE -Wall -Wextra -Werror -O3)
set_target_properties(_navigation PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${MR_SIM_PYTHON_DEVEL})
install(TARGETS _navigation DESTINATION ${MR_SIM_PYTHON_INSTALL})

catkin_install_python(PROGRAMS nodes/slam nodes/move_base DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})

install(DIRECTORY config DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})

if(CATKIN_ENABLE_TESTING)
  find_package(roslaunch REQUIRED)
  find_package(rostest REQUIRED)
  set(SLAM_NAVIGATION_RESULT ${CATKIN_TEST_RESULTS_DIR}/${PROJECT_NAME}/pytest-slam_navigation.xml)
  catkin_run_tests_target("pytest" "slam_navigation" "pytest-slam_navigation.xml"
    COMMAND "${PYTHON_EXECUTABLE} -m pytest -q ${CMAKE_CURRENT_SOURCE_DIR}/test/slam_navigation --junit-xml=${SLAM_NAVIGATION_RESULT}"
    DEPENDENCIES _world _slam _navigation)
  set(PLATFORMS_RESULT ${CATKIN_TEST_RESULTS_DIR}/${PROJECT_NAME}/pytest-platforms.xml)
  catkin_run_tests_target("pytest" "platforms" "pytest-platforms.xml"
    COMMAND "${PYTHON_EXECUTABLE} -m pytest -q ${CMAKE_CURRENT_SOURCE_DIR}/test/platforms --junit-xml=${PLATFORMS_RESULT}"
    DEPENDENCIES _slam _navigation)
  add_rostest(test/ros/slam_navigation.test DEPENDENCIES _world _slam _navigation)
  roslaunch_add_file_check(launch/slam.launch)
  roslaunch_add_file_check(launch/move_base.launch)
endif()
