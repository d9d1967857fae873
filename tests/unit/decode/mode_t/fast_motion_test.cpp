// A surface that moves too fast is called that, and frames that do not belong together never are.
#include "pipeline/decode/mode_t/fast_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kWidth = 480, kHeight = 320;

double relief(int u, int v) {
  return 47 + 2.0 * std::sin(u * 0.02) * std::cos(v * 0.025) + (u > kWidth * 2 / 3 ? 1.7 : 0.0);
}

test::FrameSet burst(const calib::Rig& rig, double motion_rad, double modulation_dn = 80, double away_mm = 0) {
  auto o = test::noisy(modulation_dn);
  o.motion_rad = motion_rad;
  return test::render(
             rig, [&](int u, int v) { return relief(u, v) + away_mm; }, o)
      .frames;
}

TEST(FastMotion, four_step_bursts_are_too_fast_and_their_motion_is_told) {
  const calib::Rig rig = test::cropped_rig(kWidth, kHeight);
  const auto decoder = BurstDecoder::make(rig, {}).value();
  EXPECT_EQ(decoder.decode(burst(rig, 0.2).view()).verdict, BurstVerdict::kAccepted);  // the control
  for (const double dn : {80.0, 30.0}) {
    for (const double motion : {-0.5, -0.35, 0.35, 0.5, 0.7}) {
      const DecodedBurst b = decoder.decode(burst(rig, motion, dn).view());
      EXPECT_EQ(b.verdict, BurstVerdict::kTooFast) << motion << ": " << name_of(b.verdict);
      EXPECT_NEAR(static_cast<double>(b.diagnostics.motion_rad), motion, 0.06);
      EXPECT_EQ(b.patch.valid_px, 0U);
    }
  }
}

TEST(FastMotion, mode_m_is_too_fast_above_the_limit) {
  const calib::Rig rig = test::micro_rig(kWidth, kHeight);
  const auto decoder = BurstDecoder::make(rig, {}).value();
  EXPECT_EQ(decoder.decode(burst(rig, 0.28).view()).verdict, BurstVerdict::kAccepted);
  EXPECT_EQ(decoder.decode(burst(rig, 0.33).view()).verdict, BurstVerdict::kTooFast);
}

FastMotion explained(const calib::Rig& rig, const test::FrameSet& frames) {
  PhaseMaps maps;
  compute_phase(frames.view(), noise_from_rig(*rig.noise, 8), {}, maps);
  return explain_by_motion(maps);
}

/// Whether the decoder's limits would call it fast.
bool is_fast(const FastMotion& m) {
  const DecodeConfig limits;
  return m.share >= limits.four_step.fast.min_moving_share &&
         std::abs(m.motion_rad) >= limits.four_step.fast.least_motion_rad;
}

TEST(FastMotion, no_order_of_frames_and_no_frame_of_another_time_is_taken_for_motion) {
  const calib::Rig rig = test::cropped_rig(kWidth, kHeight);
  const test::FrameSet good = burst(rig, 0), before = burst(rig, 0, 80, 1.1);
  EXPECT_TRUE(is_fast(explained(rig, burst(rig, 0.4))));  // the control
  std::array<std::size_t, 4> order{0, 1, 2, 3};
  do {
    test::FrameSet shuffled = good;
    for (std::size_t k = 0; k < 4; ++k) shuffled.frames[k] = good.frames[order[k]];
    EXPECT_FALSE(is_fast(explained(rig, shuffled))) << order[0] << order[1] << order[2] << order[3];
  } while (std::next_permutation(order.begin(), order.end()));
  for (std::size_t k = 0; k < 4; ++k) {
    test::FrameSet stale = good;
    stale.frames[k] = before.frames[k];
    EXPECT_FALSE(is_fast(explained(rig, stale))) << k;
  }
}

}  // namespace
}  // namespace enamel::pipeline
