# SPDX-License-Identifier: MIT
# The generator of the Standard Procedural Databases.
add_executable(spd_test ${CMAKE_CURRENT_LIST_DIR}/spd_test.cpp)
target_link_libraries(spd_test PRIVATE rayshade_spd GTest::gmock GTest::gtest GTest::gtest_main ZLIB::ZLIB)
target_compile_definitions(spd_test PRIVATE SOURCE_DIR="${PROJECT_SOURCE_DIR}")
add_test(NAME scene.spd COMMAND spd_test)
add_test(NAME scene.spd.usage COMMAND ${CMAKE_CURRENT_LIST_DIR}/spd_usage $<TARGET_FILE:spd>)
