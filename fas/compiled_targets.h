// SPDX-License-Identifier: MIT
// To be included before anything of Highway: the instruction sets that it is not to compile for. AVX3_DL
// gains nothing over AVX3 here.
#pragma once

#define HWY_DISABLED_TARGETS HWY_AVX3_DL
