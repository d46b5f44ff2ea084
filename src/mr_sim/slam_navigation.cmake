# Local SLAM (MRPT) and navigation; included by CMakeLists.txt.
find_package(mrpt-maps REQUIRED)
find_package(Eigen3 REQUIRED)

pybind11_add_module(_slam
  src/cpp/slam/bindings.cpp
  src/cpp/slam/grid_map.cpp
  src/cpp/slam/scan.cpp
  src/cpp/slam/scan_matcher.cpp
  src/cpp/slam/slam.cpp)
target_link_libraries(_slam PRIVATE mrpt::maps Eigen3::Eigen)
target_compile_options(_slam PRIVATE -Wall -Wextra -Werror -O3)
set_target_properties(_slam PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${MR_SIM_PYTHON_DEVEL})
install(TARGETS _slam DESTINATION ${MR_SIM_PYTHON_INSTALL})

pybind11_add_module(_navigation
  src/cpp/navigation/bindings.cpp
  src/cpp/navigation/march.cpp
  src/cpp/navigation/rollout.cpp)
target_compile_options(_navigation PRIVATE -Wall -Wextra -Werror -O3)
set_target_properties(_navigation PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${MR_SIM_PYTHON_DEVEL})
install(TARGETS _navigation DESTINATION ${MR_SIM_PYTHON_INSTALL})

catkin_install_python(PROGRAMS nodes/slam nodes/move_base DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
