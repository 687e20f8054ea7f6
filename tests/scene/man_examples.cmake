# SPDX-License-Identifier: MIT
# The examples of the manual page of the language are run.
add_test(NAME scene.man COMMAND ${CMAKE_CURRENT_LIST_DIR}/man_examples $<TARGET_FILE:rayshade>
  ${PROJECT_SOURCE_DIR}/man/rayshade.5)
set_tests_properties(scene.man PROPERTIES TIMEOUT 120)
