// The same burst gives the same bits from every compiler, at every optimisation level, on every instruction set.
#include <gtest/gtest.h>

#include "pipeline/types/simd.hpp"
// simd.hpp says for which sets the decoder is compiled.
#include <hwy/highway.h>

#include "tests/unit/decode/bits_scene.hpp"

namespace enamel::algo {
namespace {

void expect_bits(const calib::Rig& rig, const test::BitHashes& expected) {
  const test::BitHashes found = test::bit_hashes(rig);
  EXPECT_EQ(found.frames, expected.frames) << "the input differs, not the decoder";
  EXPECT_EQ(found.decoded, expected.decoded);
}

TEST(DecodeBits, are_those_of_every_instruction_set_of_this_machine) {
  const auto targets = hwy::SupportedAndGeneratedTargets();
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) {
    EXPECT_GE(targets.size(), 2U) << "AVX2 is not compiled in";
  }
#endif
  for (const std::int64_t target : targets) {
    hwy::SetSupportedTargetsForTest(target);
    SCOPED_TRACE(hwy::TargetName(target));
    expect_bits(test::cropped_rig(320, 160), test::kModeT);
    expect_bits(test::micro_rig(320, 160), test::kModeM);
  }
  hwy::SetSupportedTargetsForTest(0);
}

TEST(DecodeBits, are_those_of_every_other_compiler) { expect_bits(test::cropped_rig(320, 160), test::kModeT); }

TEST(DecodeBits, of_mode_m_are_those_of_every_other_compiler) { expect_bits(test::micro_rig(320, 160), test::kModeM); }

}  // namespace
}  // namespace enamel::algo
