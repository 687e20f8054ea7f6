// SPDX-License-Identifier: MIT
// Functions that the compiler makes twice, for processors with and without an instruction set; which one runs
// is decided when the program is loaded. Both give the same bits: nothing is contracted (cmake/Flags.cmake).
// Not under the thread sanitizer: it would watch the resolver, which runs before the sanitizer is ready, and
// crash.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__)
#define RAYSHADE_CLONES(TARGET) __attribute__((target_clones(TARGET, "default")))
#else
#define RAYSHADE_CLONES(TARGET)
#endif
