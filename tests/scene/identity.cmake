# SPDX-License-Identifier: MIT
# The same picture by every intersector.
set(identity ${CMAKE_CURRENT_LIST_DIR}/identity)
add_test(NAME scene.identity COMMAND ${identity} quick $<TARGET_FILE:rayshade> $<TARGET_FILE:spd> ${PROJECT_SOURCE_DIR})
add_test(NAME scene.identity-long COMMAND ${identity} long $<TARGET_FILE:rayshade> $<TARGET_FILE:spd> ${PROJECT_SOURCE_DIR})
set_tests_properties(scene.identity PROPERTIES TIMEOUT 600 PROCESSORS 2)
set_tests_properties(scene.identity-long PROPERTIES LABELS long TIMEOUT 7200 PROCESSORS 2)
