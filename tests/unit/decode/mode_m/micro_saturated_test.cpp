// Mode M on bright surfaces: one saturated phase frame is made up for by the code frame, where that says anything about
// the phase; a saturated code frame costs only its code.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

constexpr double kFull_dn = 0.97 * 255;

struct Share {
  std::size_t pixels = 0, measured = 0, saturated = 0, wrong = 0;
  double squares = 0;  ///< of the depth error over its sigma
  [[nodiscard]] double scatter_to_sigma() const { return std::sqrt(squares / static_cast<double>(measured - wrong)); }
};

struct Bright {
  Share one_clipped, several_clipped, code_clipped, clear;  ///< phase frames; two, or one and the code frame; code
  bool accepted = false;
};

/// Crests at `crest_dn`: each frame is above the limit over a strip of every fringe.
Bright decode_bright(double crest_dn, double motion_rad = 0) {
  const calib::Rig rig = test::micro_rig(400, 120);
  test::SceneOptions o;
  o.noise = true;
  o.motion_rad = motion_rad;
  o.mean_dn = 0.52 * (crest_dn - 4), o.modulation_dn = 0.48 * (crest_dn - 4);
  const auto scene = test::render(rig, test::flat(48), o);
  const DecodedBurst burst = BurstDecoder::make(rig).value().decode(scene.frames.view());
  Bright out;
  out.accepted = burst.accepted();
  for (std::size_t i = 0; i < burst.reject.size(); ++i) {
    const auto over = [&](std::size_t k) { return scene.frames.frames[k][i] >= kFull_dn; };
    const int phase_frames = (over(0) ? 1 : 0) + (over(2) ? 1 : 0) + (over(3) ? 1 : 0);
    const bool several = phase_frames > 1 || (phase_frames == 1 && over(1));
    Share& share = several ? out.several_clipped
                           : (phase_frames == 1 ? out.one_clipped : (over(1) ? out.code_clipped : out.clear));
    ++share.pixels;
    share.saturated += burst.reject[i] == PixelReject::kSaturated ? 1U : 0U;
    const auto z = static_cast<double>(burst.patch.depth_mm[i]);
    if (std::isnan(z)) continue;
    ++share.measured;
    share.wrong += std::abs(z - 48) > 1 ? 1U : 0U;  // a wrong order is 3.5 mm off
    if (std::abs(z - 48) < 1) share.squares += std::pow((z - 48) / static_cast<double>(burst.patch.sigma_mm[i]), 2);
  }
  return out;
}

TEST(MicroSaturated, one_phase_frame_above_full_scale_is_made_up_for_by_the_code_frame) {
  for (const double motion : {0.0, 0.1}) {
    const Bright b = decode_bright(252, motion);
    ASSERT_TRUE(b.accepted);
    EXPECT_GT(b.one_clipped.pixels, 3000U);
    EXPECT_GT(b.one_clipped.measured, b.one_clipped.pixels / 2);
    EXPECT_EQ(b.one_clipped.wrong, 0U);
    EXPECT_NEAR(b.one_clipped.scatter_to_sigma(), 1, 0.1) << motion;
    EXPECT_EQ(b.one_clipped.measured + b.one_clipped.saturated, b.one_clipped.pixels) << "the rest keeps its reason";
  }
}

TEST(MicroSaturated, two_frames_above_full_scale_cost_the_pixel_under_that_name) {
  const Bright b = decode_bright(252);
  EXPECT_GT(b.several_clipped.pixels, 300U);
  EXPECT_EQ(b.several_clipped.measured, 0U);
  EXPECT_EQ(b.several_clipped.saturated, b.several_clipped.pixels);
  EXPECT_GT(b.code_clipped.pixels, 800U);
  EXPECT_GT(b.code_clipped.measured, b.code_clipped.pixels * 7 / 10);
  // What clips cut off on both sides is a strip of a sixth of a fringe, too thin here and there to be placed.
  EXPECT_GT(b.clear.measured, b.clear.pixels * 8 / 10);
}

TEST(MicroSaturated, crests_below_the_limit_cost_nothing) {  // the control
  const Bright b = decode_bright(225);
  ASSERT_TRUE(b.accepted);
  EXPECT_EQ(b.one_clipped.pixels + b.several_clipped.pixels, 0U);
  EXPECT_GT(b.clear.measured, b.clear.pixels * 97 / 100);
}

}  // namespace
}  // namespace enamel::pipeline
