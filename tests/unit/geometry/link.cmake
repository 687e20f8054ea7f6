# SPDX-License-Identifier: MIT
target_link_libraries(geometry_test PRIVATE rayshade_lang)
