# SPDX-License-Identifier: MIT
# find_package(fas) gives the target fas::fas.
include(CMakeFindDependencyMacro)
find_dependency(Threads)
find_dependency(PkgConfig)
pkg_check_modules(HWY REQUIRED QUIET IMPORTED_TARGET libhwy)
include(${CMAKE_CURRENT_LIST_DIR}/fas-targets.cmake)
