// SPDX-License-Identifier: MIT
// Tests that run once for every instruction set that was compiled and that this processor has.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "fas/dispatch.h"

namespace fas::test {

/// While such a test runs, calls go to the target that is the parameter.
class TargetTest : public testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override { pretend_targets(GetParam()); }
  void TearDown() override { pretend_targets(0); }
};

inline std::string target_name(const testing::TestParamInfo<std::int64_t>& info) {
  return hwy::TargetName(info.param);
}

inline std::vector<std::int64_t> targets() {
  std::vector<std::int64_t> out;
  for (std::int64_t left = supported_targets(); left != 0; left &= left - 1) out.push_back(left & -left);
  return out;
}

}  // namespace fas::test
