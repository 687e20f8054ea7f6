# SPDX-License-Identifier: MIT
# Whole textures are tested from scene text.
target_link_libraries(texture_test PRIVATE rayshade_lang)
