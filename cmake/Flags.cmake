# SPDX-License-Identifier: MIT
# Flags of every target. Exact code must not be contracted or reassociated: pictures are the same bytes whatever
# compiler, optimisation level or processor made them (docs/determinism.md).
add_library(rayshade_flags INTERFACE)
target_compile_options(rayshade_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror
  -ffp-contract=off -fno-fast-math -fno-math-errno -fno-trapping-math)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # False positives of GCC 12 in optimised std::string and std::optional code.
  target_compile_options(rayshade_flags INTERFACE -Wno-maybe-uninitialized -Wno-restrict -Wno-stringop-overflow
    -Wno-array-bounds)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
  # Records of a hundred bytes are made a million times a second; by itself g++ clears and copies them with string
  # instructions, whose start alone takes tens of cycles.
  target_compile_options(rayshade_flags INTERFACE -mmemset-strategy=unrolled_loop:512:noalign,libcall:-1:noalign
    -mmemcpy-strategy=unrolled_loop:512:noalign,libcall:-1:noalign)
endif()
target_link_options(rayshade_flags INTERFACE -Wl,-z,relro,-z,now)
target_include_directories(rayshade_flags INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR})
target_compile_definitions(rayshade_flags INTERFACE FMT_HEADER_ONLY=1)
if(RAYSHADE_SANITIZE)
  target_compile_options(rayshade_flags INTERFACE -fsanitize=${RAYSHADE_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all)
  target_link_options(rayshade_flags INTERFACE -fsanitize=${RAYSHADE_SANITIZE})
endif()
set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG")
set(CMAKE_CXX_FLAGS_DEBUG "-O0 -g")
