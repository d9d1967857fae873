// The same burst gives the same bits from every compiler, at every optimisation level, on every instruction set.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>

#include "pipeline/types/simd.hpp"
// simd.hpp says for which sets the decoder is compiled.
#include <hwy/highway.h>

#include "tests/unit/decode/bits_scene.hpp"

namespace enamel::pipeline {
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

/// Pixels with one clipped frame that were measured all the same.
std::size_t saturated_and_measured(const calib::Rig& rig) {
  const test::FrameSet frames = test::bits_burst(rig);
  const DecodedBurst burst = BurstDecoder::make(rig).value().decode(frames.view());
  std::size_t count = 0;
  for (std::size_t i = 0; i < burst.reject.size(); ++i) {
    const bool clipped = std::ranges::any_of(frames.frames, [&](const auto& frame) { return frame[i] > 247; });
    count += clipped && burst.reject[i] == PixelReject::kNone ? 1U : 0U;
  }
  return count;
}

TEST(DecodeBits, are_those_of_a_burst_with_clipped_frames_and_passing_edges) {
  const calib::Rig t = test::cropped_rig(320, 160), m = test::micro_rig(320, 160);
  EXPECT_GT(saturated_and_measured(t), 20U);
  EXPECT_GT(saturated_and_measured(m), 20U);
  DecodeConfig nothing_back;
  nothing_back.four_step.torn.reach_px = 0;
  EXPECT_NE(test::bit_hashes(t, nothing_back).decoded, test::kModeT.decoded);
}

}  // namespace
}  // namespace enamel::pipeline
