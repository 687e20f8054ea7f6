# SPDX-License-Identifier: MIT
# Scenes with known pictures, rendered by the built program.
add_executable(scene_checks_test ${CMAKE_CURRENT_LIST_DIR}/check_values_test.cpp ${CMAKE_CURRENT_LIST_DIR}/check_file.cpp)
target_link_libraries(scene_checks_test PRIVATE rayshade_flags GTest::gtest)
target_compile_definitions(scene_checks_test PRIVATE SOURCE_DIR="${PROJECT_SOURCE_DIR}" BINARY_DIR="${PROJECT_BINARY_DIR}")
if(TARGET rayshade)
  add_dependencies(scene_checks_test rayshade)
endif()
add_test(NAME scene.checks COMMAND scene_checks_test)
set_tests_properties(scene.checks PROPERTIES LABELS scene TIMEOUT 900)
