# The protocol engine: a static library without ROS, and its tests. Included by CMakeLists.txt.
option(ADHOC_SANITIZE "Build the protocol engine with AddressSanitizer and UndefinedBehaviorSanitizer" OFF)

# Reading the headers is most of the work on small files: so many are compiled as one, which takes less than half of the time.
# Names in unnamed namespaces are therefore different in all files of a target. (CMake 3.16 and later.)
set(ADHOC_FILES_AT_ONCE 16)

find_path(ZSTD_INCLUDE_DIR zstd.h)
find_library(ZSTD_LIBRARY zstd)
find_path(ISAL_INCLUDE_DIR isa-l/erasure_code.h)
find_library(ISAL_LIBRARY isal)
find_path(SODIUM_INCLUDE_DIR sodium.h)
find_library(SODIUM_LIBRARY sodium)
# find_path and find_library know REQUIRED from CMake 3.18 on only.
foreach(needed ZSTD ISAL SODIUM)
  if(NOT ${needed}_INCLUDE_DIR OR NOT ${needed}_LIBRARY)
    message(FATAL_ERROR "Not found: ${needed}. On Debian: apt install libzstd-dev libisal-dev libsodium-dev")
  endif()
endforeach()

set(ADHOC_ENGINE_DIR ${CMAKE_CURRENT_LIST_DIR})
file(GLOB ADHOC_ENGINE_SOURCES CONFIGURE_DEPENDS
  ${ADHOC_ENGINE_DIR}/src/*.cpp
  ${ADHOC_ENGINE_DIR}/src/air/*.cpp
  ${ADHOC_ENGINE_DIR}/src/api/*.cpp
  ${ADHOC_ENGINE_DIR}/src/engine/*.cpp
  ${ADHOC_ENGINE_DIR}/src/presence/*.cpp
  ${ADHOC_ENGINE_DIR}/src/wire/*.cpp
  ${ADHOC_ENGINE_DIR}/src/routing/*.cpp
  ${ADHOC_ENGINE_DIR}/src/security/*.cpp
  ${ADHOC_ENGINE_DIR}/src/transport/*.cpp
  ${ADHOC_ENGINE_DIR}/src/multicast/*.cpp)

add_library(adhoc_engine STATIC ${ADHOC_ENGINE_SOURCES})
set_target_properties(adhoc_engine PROPERTIES POSITION_INDEPENDENT_CODE ON)
set_target_properties(adhoc_engine PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${ADHOC_FILES_AT_ONCE})
target_compile_features(adhoc_engine PUBLIC cxx_std_17)
target_compile_options(adhoc_engine PRIVATE -Wall -Wextra -Werror)
target_include_directories(adhoc_engine PUBLIC ${ADHOC_ENGINE_DIR}/include ${ADHOC_ENGINE_DIR}/src
                           PRIVATE ${ISAL_INCLUDE_DIR} ${SODIUM_INCLUDE_DIR} ${ZSTD_INCLUDE_DIR})
target_link_libraries(adhoc_engine PUBLIC ${ISAL_LIBRARY} ${SODIUM_LIBRARY} ${ZSTD_LIBRARY})
if(ADHOC_SANITIZE)
  target_compile_options(adhoc_engine PUBLIC -fsanitize=address,undefined -fno-sanitize-recover=undefined)
  target_link_libraries(adhoc_engine PUBLIC -fsanitize=address,undefined)
endif()

# The simulated radio, which a robot's node does not link.
file(GLOB ADHOC_MEDIUM_SOURCES CONFIGURE_DEPENDS ${ADHOC_ENGINE_DIR}/src/medium/*.cpp)
add_library(adhoc_medium STATIC ${ADHOC_MEDIUM_SOURCES} ${ADHOC_ENGINE_DIR}/src/propagation/path_loss.cpp)
set_target_properties(adhoc_medium PROPERTIES POSITION_INDEPENDENT_CODE ON)
target_compile_options(adhoc_medium PRIVATE -Wall -Wextra -Werror)
target_link_libraries(adhoc_medium PUBLIC adhoc_engine)

# Robots in one process on the simulated radio.
add_library(adhoc_simulation STATIC EXCLUDE_FROM_ALL ${ADHOC_ENGINE_DIR}/src/simulation/team.cpp)
set_target_properties(adhoc_simulation PROPERTIES POSITION_INDEPENDENT_CODE ON)
target_compile_options(adhoc_simulation PRIVATE -Wall -Wextra -Werror)
target_link_libraries(adhoc_simulation PUBLIC adhoc_medium)

# What tests and benchmarks of the engine share.
add_library(adhoc_engine_test_support STATIC EXCLUDE_FROM_ALL ${ADHOC_ENGINE_DIR}/test/engine/host.cpp
            ${ADHOC_ENGINE_DIR}/test/engine/payloads.cpp ${ADHOC_ENGINE_DIR}/test/engine/protocol_vectors.cpp)
target_include_directories(adhoc_engine_test_support PUBLIC ${ADHOC_ENGINE_DIR}/test/engine)
target_link_libraries(adhoc_engine_test_support PUBLIC adhoc_simulation)

# Random scenarios with the engine's promises checked after every event.
file(GLOB ADHOC_SCENARIO_SOURCES CONFIGURE_DEPENDS ${ADHOC_ENGINE_DIR}/test/engine/scenarios/*.cpp)
list(REMOVE_ITEM ADHOC_SCENARIO_SOURCES ${ADHOC_ENGINE_DIR}/test/engine/scenarios/engine_scenarios.cpp)
add_library(adhoc_engine_scenarios STATIC EXCLUDE_FROM_ALL ${ADHOC_SCENARIO_SOURCES})
target_compile_options(adhoc_engine_scenarios PRIVATE -Wall -Wextra -Werror)
target_include_directories(adhoc_engine_scenarios PUBLIC ${ADHOC_ENGINE_DIR}/test/engine/scenarios)
target_link_libraries(adhoc_engine_scenarios PUBLIC adhoc_engine_test_support)
add_executable(engine_scenarios EXCLUDE_FROM_ALL ${ADHOC_ENGINE_DIR}/test/engine/scenarios/engine_scenarios.cpp)
target_compile_options(engine_scenarios PRIVATE -Wall -Wextra -Werror)
target_link_libraries(engine_scenarios adhoc_engine_scenarios)

if(CATKIN_ENABLE_TESTING)
  file(GLOB ADHOC_ENGINE_TESTS CONFIGURE_DEPENDS ${ADHOC_ENGINE_DIR}/test/engine/test_*.cpp)
  catkin_add_gtest(${PROJECT_NAME}_engine_test ${ADHOC_ENGINE_TESTS} TIMEOUT 300)
  if(TARGET ${PROJECT_NAME}_engine_test)
    target_compile_options(${PROJECT_NAME}_engine_test PRIVATE -O0)
    set_target_properties(${PROJECT_NAME}_engine_test PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${ADHOC_FILES_AT_ONCE})
    target_link_libraries(${PROJECT_NAME}_engine_test adhoc_engine_scenarios gtest_main)
    set_property(SOURCE ${ADHOC_ENGINE_DIR}/test/engine/test_protocol_vectors.cpp APPEND PROPERTY
      COMPILE_DEFINITIONS PROTOCOL_VECTORS="${ADHOC_ENGINE_DIR}/docs/protocol_vectors.json")
    set_property(SOURCE ${ADHOC_ENGINE_DIR}/test/engine/test_scenarios.cpp APPEND PROPERTY
      COMPILE_DEFINITIONS TRACE_HASHES="${ADHOC_ENGINE_DIR}/test/engine/scenarios/trace_hashes.txt")
  endif()
endif()

file(GLOB ADHOC_BENCH_SOURCES CONFIGURE_DEPENDS ${ADHOC_ENGINE_DIR}/test/bench/*.cpp)
# Benchmarks are built when they are asked for: `make bench-adhoc`.
add_custom_target(${PROJECT_NAME}_benchmarks)
add_executable(bench_engine EXCLUDE_FROM_ALL ${ADHOC_BENCH_SOURCES})
target_link_libraries(bench_engine adhoc_engine_test_support)
if(COMMAND catkin_package)
  install(TARGETS bench_engine RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION} OPTIONAL)
endif()

# The memory of one engine.
file(GLOB ADHOC_MEMORY_SOURCES CONFIGURE_DEPENDS ${ADHOC_ENGINE_DIR}/test/bench/memory/*.cpp)
add_executable(bench_memory EXCLUDE_FROM_ALL ${ADHOC_MEMORY_SOURCES} ${ADHOC_ENGINE_DIR}/test/bench/rows.cpp)
target_include_directories(bench_memory PRIVATE ${ADHOC_ENGINE_DIR}/test/bench)
target_link_libraries(bench_memory adhoc_engine_test_support)
if(COMMAND catkin_package)
  install(TARGETS bench_memory RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION} OPTIONAL)
endif()

# The simulated radio alone.
add_executable(bench_medium EXCLUDE_FROM_ALL ${ADHOC_ENGINE_DIR}/test/engine/bench_medium.cpp)
target_link_libraries(bench_medium adhoc_medium)
if(COMMAND catkin_package)
  install(TARGETS bench_medium RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION} OPTIONAL)
endif()
add_dependencies(${PROJECT_NAME}_benchmarks bench_engine bench_memory bench_medium)
