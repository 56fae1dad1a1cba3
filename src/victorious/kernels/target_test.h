// Tests of kernels that run once for every instruction set of this machine.
#pragma once

#include <cctype>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/targets.h>

namespace victorious::kernels {

/// Lets Highway use one instruction set only: the parameter.
class TargetTest : public ::testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override { Choose(GetParam()); }
  void TearDown() override { Choose(0); }  // Highway's own choice

  static void Choose(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().DeInit();  // the next call dispatches again
  }
};

/// The instruction sets of this machine that kernels are compiled for: all of Highway's but SVE (no_sve.h).
inline std::vector<std::int64_t> TestedTargets() {
  std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  std::erase_if(targets, [](std::int64_t t) { return (t & (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)) != 0; });
  return targets;
}

inline std::string TargetTestName(const ::testing::TestParamInfo<std::int64_t>& info) {
  std::string name = hwy::TargetName(info.param);
  std::erase_if(name, [](unsigned char c) { return c != '_' && std::isalnum(c) == 0; });
  return name;
}

}  // namespace victorious::kernels

#define VICTORIOUS_EVERY_TARGET(suite)                                                                      \
  INSTANTIATE_TEST_SUITE_P(EveryTarget, suite, ::testing::ValuesIn(::victorious::kernels::TestedTargets()), \
                           ::victorious::kernels::TargetTestName)
