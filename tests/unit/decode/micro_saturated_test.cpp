// Mode M on bright surfaces: a saturated phase frame costs the pixel, a saturated code frame only its code.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pipeline/algo/decode/burst_decoder.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::algo {
namespace {

constexpr double kFull_dn = 0.97 * 255;

struct Share {
  std::size_t pixels = 0, measured = 0, saturated = 0;
};

struct Bright {
  Share phase_clipped, code_clipped, clear;
  bool accepted = false;
};

/// Crests at `crest_dn`: each frame is above the limit over a strip of every fringe.
Bright decode_bright(double crest_dn) {
  const calib::Rig rig = test::micro_rig(400, 120);
  test::SceneOptions o;
  o.noise = true;
  o.mean_dn = 0.52 * (crest_dn - 4), o.modulation_dn = 0.48 * (crest_dn - 4);
  const auto scene = test::render(rig, test::flat(48), o);
  const DecodedBurst burst = BurstDecoder::make(rig).value().decode(scene.frames.view());
  Bright out;
  out.accepted = burst.accepted();
  for (std::size_t i = 0; i < burst.reject.size(); ++i) {
    const auto over = [&](std::size_t k) { return scene.frames.frames[k][i] >= kFull_dn; };
    Share& share = over(0) || over(2) || over(3) ? out.phase_clipped : (over(1) ? out.code_clipped : out.clear);
    ++share.pixels;
    share.measured += std::isnan(burst.patch.depth_mm[i]) ? 0U : 1U;
    share.saturated += burst.reject[i] == PixelReject::kSaturated ? 1U : 0U;
  }
  return out;
}

TEST(MicroSaturated, phase_frames_above_full_scale_cost_the_pixel_under_that_name) {
  const Bright b = decode_bright(252);
  ASSERT_TRUE(b.accepted);
  EXPECT_GT(b.phase_clipped.pixels, 4000U);
  EXPECT_EQ(b.phase_clipped.measured, 0U);
  EXPECT_EQ(b.phase_clipped.saturated, b.phase_clipped.pixels);
  EXPECT_GT(b.code_clipped.pixels, 800U);
  EXPECT_GT(b.code_clipped.measured, b.code_clipped.pixels * 7 / 10);
  // What clips cut off on both sides is a strip of a sixth of a fringe, too thin here and there to be placed.
  EXPECT_GT(b.clear.measured, b.clear.pixels * 8 / 10);
}

TEST(MicroSaturated, crests_below_the_limit_cost_nothing) {  // the control
  const Bright b = decode_bright(225);
  ASSERT_TRUE(b.accepted);
  EXPECT_EQ(b.phase_clipped.pixels, 0U);
  EXPECT_GT(b.clear.measured, b.clear.pixels * 97 / 100);
}

}  // namespace
}  // namespace enamel::algo
