# SPDX-License-Identifier: MIT
target_link_libraries(fas_test PRIVATE rayshade_flags Threads::Threads)
