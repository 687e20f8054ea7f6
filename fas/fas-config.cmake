# SPDX-License-Identifier: MIT
# find_package(fas) gives the target fas::fas.
include(CMakeFindDependencyMacro)
find_dependency(Threads)
include(${CMAKE_CURRENT_LIST_DIR}/fas-targets.cmake)
