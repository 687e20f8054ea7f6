# SPDX-License-Identifier: MIT
# The example scenes.
add_test(NAME scene.examples COMMAND ${CMAKE_CURRENT_LIST_DIR}/examples $<TARGET_FILE:rayshade>
  ${PROJECT_SOURCE_DIR}/scenes)
set_tests_properties(scene.examples PROPERTIES TIMEOUT 300)
