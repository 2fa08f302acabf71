#ifndef ALIDADE_TESTS_SUPPORT_VECTOR_TARGETS_H_
#define ALIDADE_TESTS_SUPPORT_VECTOR_TARGETS_H_

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstdint>
#include <string>
#include <vector>

namespace alidade::internal::testing {

/// Runs a test once for every instruction set of this machine that the kernels
/// may have been compiled for; those that they were not fall back to a smaller
/// one.
class VectorTargetTest : public ::testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override { Choose(GetParam()); }
  void TearDown() override { Choose(0); }

 private:
  static void Choose(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

/// Bits of hwy/detect_targets.h that the kernels are compiled for and the
/// machine has.
inline auto AllVectorTargets() {
  std::vector<std::int64_t> targets;
  for (const std::int64_t target :
       {HWY_AVX3, HWY_AVX2, HWY_SSE4, HWY_NEON, HWY_EMU128}) {
    const bool is_there = (hwy::SupportedTargets() & target) != 0;
    if (is_there) targets.push_back(target);
  }
  return ::testing::ValuesIn(targets);
}

inline std::string TargetName(
    const ::testing::TestParamInfo<std::int64_t>& info) {
  return hwy::TargetName(info.param);
}

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_VECTOR_TARGETS_H_
