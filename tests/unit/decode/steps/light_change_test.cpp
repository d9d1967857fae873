// Bursts under a lamp that swings with the mains: its light is taken off; a steady one changes nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

/// In mode T and in mode M.
class LightChangeOf : public testing::TestWithParam<bool> {
 protected:
  static const calib::Rig& rig() {
    static const calib::Rig kT = test::cropped_rig(448, 192), kM = test::micro_rig(448, 192);
    return GetParam() ? kM : kT;
  }
  static DecodedBurst decode(const test::FrameSet& frames, bool corrected = true) {
    DecodeConfig config;
    if (!corrected) config.light_change.least_rad = 1e9;
    return BurstDecoder::make(rig(), config).value().decode(frames.view());
  }
  static test::FrameSet burst(std::uint64_t seed) {
    test::SceneOptions o;
    o.noise = true;
    o.seed = seed;
    return test::render(
               rig(), [](int u, int v) { return 46 + 0.004 * u + 0.004 * v; }, o)
        .frames;
  }
  /// A lamp of 10 DN at the right border and half of that at the left, which swings by `depth` at 100 Hz.
  static test::FrameSet lit(test::FrameSet frames, double depth, double phase_rad) {
    const auto width = static_cast<std::size_t>(rig().camera.width);
    for (std::size_t k = 0; k < 4; ++k) {
      const double swing =
          1 + depth * std::cos(2 * std::numbers::pi * 100 * 0.004 * static_cast<double>(k) + phase_rad);
      for (std::size_t i = 0; i < frames.frames[k].size(); ++i) {
        const double lamp = 10 * swing * (0.5 + 0.5 * static_cast<double>(i % width) / static_cast<double>(width));
        const double all = static_cast<double>(frames.frames[k][i]) + lamp;
        frames.frames[k][i] = static_cast<std::uint8_t>(std::clamp(std::lround(all), 0L, 255L));
      }
    }
    return frames;
  }
  /// Frame k brighter by `gain`, and nobody says so.
  static test::FrameSet exposed(test::FrameSet frames, std::size_t k, double gain) {
    for (std::uint8_t& dn : frames.frames[k])
      dn = static_cast<std::uint8_t>(std::clamp(std::lround(gain * static_cast<double>(dn)), 0L, 255L));
    return frames;
  }
  /// Rms of what one depth is off the other by, um; rounding alone leaves some 3.
  static double off_um(const DecodedBurst& a, const DecodedBurst& b) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < a.patch.depth_mm.size(); ++i) {
      const double off = 1e3 * static_cast<double>(a.patch.depth_mm[i] - b.patch.depth_mm[i]);
      if (std::abs(off) < 200) sum += off * off, count += 1;
    }
    return std::sqrt(sum / count);
  }
};

INSTANTIATE_TEST_SUITE_P(Modes, LightChangeOf, testing::Bool(),
                         [](const auto& mode) { return mode.param ? "M" : "T"; });

TEST_P(LightChangeOf, is_taken_off) {
  const test::FrameSet frames = burst(1);
  const DecodedBurst steady = decode(lit(frames, 0, 0));
  ASSERT_TRUE(steady.accepted());
  for (const double phase_rad : {0.0, 1.2, 2.4}) {
    const DecodedBurst flickers = decode(lit(frames, 0.3, phase_rad));
    ASSERT_TRUE(flickers.accepted()) << phase_rad << ' ' << name_of(flickers.verdict);
    EXPECT_LT(off_um(flickers, steady), 8) << phase_rad;
    EXPECT_GT(flickers.diagnostics.light_ripple_rad, 3e-3) << phase_rad;
    EXPECT_GT(flickers.patch.valid_px, steady.patch.valid_px * 99 / 100) << phase_rad;
  }
}

TEST_P(LightChangeOf, would_ripple_depth_or_cost_the_burst) {  // the control of the test above
  const test::FrameSet frames = burst(1);
  const DecodedBurst steady = decode(lit(frames, 0, 0)), left = decode(lit(frames, 0.3, 1.2), false);
  EXPECT_TRUE(!left.accepted() || off_um(left, steady) > off_um(decode(lit(frames, 0.3, 1.2)), steady));
}

TEST_P(LightChangeOf, steady_light_leaves_every_bit) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const test::FrameSet frames = lit(burst(seed), 0, 0);
    const DecodedBurst asked = decode(frames), unasked = decode(frames, false);
    ASSERT_TRUE(asked.accepted());
    EXPECT_LT(asked.diagnostics.light_ripple_rad, 3e-3) << seed;
    const auto same = [](float a, float b) { return a == b || (a != a && b != b); };
    EXPECT_TRUE(std::ranges::equal(asked.patch.depth_mm.pixels(), unasked.patch.depth_mm.pixels(), same)) << seed;
    EXPECT_TRUE(std::ranges::equal(asked.patch.sigma_mm.pixels(), unasked.patch.sigma_mm.pixels(), same)) << seed;
  }
}

TEST_P(LightChangeOf, a_frame_of_another_gain_is_refused_or_does_no_harm) {
  const test::FrameSet frames = burst(3);
  const DecodedBurst as_one = decode(frames);
  ASSERT_TRUE(as_one.accepted());
  for (std::size_t k = 0; k < 4; ++k) {
    for (const double gain : {0.6, 0.75, 1.3, 1.6}) {
      EXPECT_FALSE(decode(exposed(frames, k, gain)).accepted()) << k << ' ' << gain;
    }
    for (const double gain : {0.98, 1.02}) {
      const DecodedBurst other = decode(exposed(frames, k, gain)), left = decode(exposed(frames, k, gain), false);
      ASSERT_TRUE(other.accepted()) << k << ' ' << gain;
      EXPECT_GT(other.diagnostics.light_ripple_rad, 3e-3) << k << ' ' << gain;
      EXPECT_LT(off_um(other, as_one), 8) << k << ' ' << gain;
      EXPECT_GT(off_um(left, as_one), off_um(other, as_one)) << "control " << k << ' ' << gain;
    }
  }
}

}  // namespace
}  // namespace enamel::pipeline
