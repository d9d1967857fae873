// Ripple of a projector that is in focus at one depth only: its third harmonic fades with distance from there.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/support/fold_error.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kWidth = 480, kHeight = 240;

/// A plane that crosses the depth range from left to right.
double slanted(int u, int /*v*/) { return 43 + 11.0 * u / kWidth; }

struct Left {
  double own = 0;        ///< ripple, rad rms, of the decoder's phase
  double one_level = 0;  ///< the same with the burst's mean ripple put in place of what changes with depth
  double by_depth_rad = 0;
};

/// Worst of four ranges of depth: a mean over all depths would hide what changes its sign.
Left ripple_left(const std::function<double(double)>& third) {
  const calib::Rig rig = test::cropped_rig(kWidth, kHeight);
  auto options = test::noisy();
  options.third = third;
  const auto scene = test::render(rig, slanted, options);
  const DecodedBurst burst = BurstDecoder::make(rig, {}).value().decode(scene.frames.view());
  EXPECT_TRUE(burst.accepted());
  Left out{.by_depth_rad = burst.diagnostics.ripple_by_depth_rad};
  for (int quarter = 0; quarter < 4; ++quarter) {
    test::ErrorFolder own, level;
    for (int v = 0; v < kHeight; ++v) {
      for (int u = quarter * kWidth / 4; u < (quarter + 1) * kWidth / 4; ++u) {
        const double truth = scene.phase_rad(u, v), z = scene.depth_mm(u, v);
        const double measured = static_cast<double>(burst.phase_rad(u, v));
        if (burst.reject(u, v) != PixelReject::kNone) continue;
        own.add(test::wrap_pi(measured - truth), truth);
        // Four steps see cos 3x as B3 (cos 3x, -sin 3x): the angle is off by -B3/B sin 4x to first order.
        level.add(-third(z) * std::sin(4 * truth) - burst.diagnostics.ripple.error_rad(truth), truth);
      }
    }
    out.own = std::max(out.own, own.result().repeating_rad);
    out.one_level = std::max(out.one_level, level.result().repeating_rad);
  }
  return out;
}

TEST(RippleByDepth, a_fading_harmonic_is_taken_off_at_every_depth) {
  const Left left = ripple_left([](double z) { return 0.025 * std::exp(-0.02 * (z - 45) * (z - 45)); });
  RecordProperty("one_level_rad", std::to_string(left.one_level));
  RecordProperty("by_depth_rad", std::to_string(left.own));
  EXPECT_GT(left.one_level, 0.005);  // the control: what one level for all depths leaves
  EXPECT_LT(left.own, left.one_level / 3);
  EXPECT_LT(left.own, 2e-3);
  EXPECT_GT(left.by_depth_rad, 0.003);
}

TEST(RippleByDepth, nothing_is_made_up_where_nothing_changes) {
  EXPECT_EQ(ripple_left([](double) { return 0.0; }).by_depth_rad, 0);
  const Left even = ripple_left([](double) { return 0.02; });
  EXPECT_LT(even.by_depth_rad, 5e-4);
  EXPECT_LT(even.own, 1.5e-3);
}

}  // namespace
}  // namespace enamel::pipeline
