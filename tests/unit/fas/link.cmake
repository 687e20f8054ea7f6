# SPDX-License-Identifier: MIT
target_link_libraries(fas_test PRIVATE PkgConfig::HWY Threads::Threads)
