// Motion during the burst, on a textured ball that moves between the frames.
#include "pipeline/decode/motion/rigid_motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/unit/decode/moving_ball.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

using Eigen::Vector3d;
using test::MovingBall;

DecodedBurst decode(const calib::Rig& rig, const test::FrameSet& frames, int passes, bool dense = true) {
  DecodeConfig config;
  config.rigid.passes = passes;
  config.rigid.dense = dense;
  return BurstDecoder::make(rig, config).value().decode(frames.view());
}

class RigidMotionOf : public test::BothModes {};

INSTANTIATE_TEST_SUITE_P(Modes, RigidMotionOf, testing::Bool(),
                         [](const auto& mode) { return mode.param ? "M" : "T"; });

TEST_P(RigidMotionOf, finds_shift_and_turn_and_takes_their_ripple_off_the_surface) {
  const MovingBall ball{rig(), {0.030, -0.015, 0.024}, {0.0006, -0.0004, 0.0010}};
  const auto burst = ball.render(false);
  const DecodedBurst found = decode(ball.rig, burst, 2), blocks = decode(ball.rig, burst, 0);
  ASSERT_TRUE(found.accepted());
  const RigidMotion& m = found.diagnostics.rigid;
  ASSERT_TRUE(m.moved);
  const Vector3d pivot(0, 0, 2 / (1.0 / 40 + 1.0 / 56));
  const Vector3d shift = Eigen::Map<const Vector3d>(m.shift_mm.data()),
                 turn = Eigen::Map<const Vector3d>(m.turn_rad.data());
  const Vector3d of_centre = shift + turn.cross(ball.centre_mm - pivot);
  EXPECT_LT((of_centre - ball.shift_mm).norm(), 0.02 * ball.shift_mm.norm()) << of_centre.transpose();
  EXPECT_LT((turn - ball.turn_rad).norm(), 3e-4) << "a ball's turn shows in its texture alone: " << turn.transpose();

  const MovingBall still = ball.at_rest();
  const double floor = still.sigma_um(decode(ball.rig, still.render(false), 2));  // rounding to 8 bit
  const auto ripple = [&](const DecodedBurst& b) {
    return std::sqrt(std::max(0.01, std::pow(ball.sigma_um(b), 2) - floor * floor));
  };
  EXPECT_LT(ripple(found), 2.0);
  EXPECT_GT(ripple(blocks), 2 * ripple(found)) << "negative control: each block's motion by itself";
}

/// Lit from the right, the left flank of a small ball grows darker by a twentieth from frame to frame as it passes, and
/// its light, slope and rate change on the way.
TEST_P(RigidMotionOf, form_of_a_ball_survives_where_light_grazes_it) {
  MovingBall ball{rig(), {-0.030, 0, 0}, Vector3d::Zero()};
  ball.radius_mm = 3, ball.centre_mm = {0.3, 0.2, 47.5}, ball.texture = 0;
  const auto burst = ball.render(true);
  const DecodedBurst found = decode(ball.rig, burst, 2), blocks = decode(ball.rig, burst, 0);
  ASSERT_TRUE(found.accepted());
  EXPECT_LT(std::abs(ball.error_um(found, -0.75, -0.55)), 1.5);
  EXPECT_GT(std::abs(ball.error_um(blocks, -0.75, -0.55)), 4) << "negative control: blocks that know no light";
  EXPECT_LT(std::abs(ball.error_um(found, -0.2, 0.2)), 0.5);
}

/// A ball as narrow as a cusp: its slope changes within the reach of the nodes that the motion is found from.
TEST(RigidMotion, follows_a_narrow_surface) {
  MovingBall ball{test::cropped_rig(480, 360), {0.040, 0, 0.020}, Vector3d::Zero()};
  ball.radius_mm = 2.5, ball.centre_mm = {0.3, 0.2, 47.5};
  const auto burst = ball.render(false);
  const DecodedBurst found = decode(ball.rig, burst, 2), coarse = decode(ball.rig, burst, 2, false);
  ASSERT_TRUE(found.accepted() && found.diagnostics.rigid.moved);
  const MovingBall still = ball.at_rest();
  const double floor = still.sigma_um(decode(ball.rig, still.render(false), 2));  // rounding to 8 bit
  const auto left = [&](const DecodedBurst& b) { return std::pow(ball.sigma_um(b), 2) - floor * floor; };
  EXPECT_LT(left(found), 0.75 * left(coarse)) << left(found) << " of " << left(coarse) << " um^2, floor " << floor;
}

/// Of a small ball that passes, a pixel sees z + x^2/2R: frames at times t put it <t^2> shift^2 / 2R behind mid-burst,
/// by 0.9 um in mode T (<t^2> = 1.25) and by 1.1 in mode M (1.58), unless the change of rate is known.
TEST_P(RigidMotionOf, a_ball_that_passes_is_where_it_was_at_mid_burst) {
  MovingBall ball{rig(), {0.060, 0, 0}, Vector3d::Zero()};
  ball.radius_mm = 2.5, ball.centre_mm = {0.3, 0.2, 50.5};
  const auto burst = ball.render(false);
  const DecodedBurst found = decode(ball.rig, burst, 2), blocks = decode(ball.rig, burst, 0);
  ASSERT_TRUE(found.diagnostics.rigid.moved);
  EXPECT_LT(std::abs(ball.error_um(found, -0.4, 0.4)), 0.4);
  // In mode T the light that blocks do not know happens to hide it.
  if (GetParam()) {
    EXPECT_GT(std::abs(ball.error_um(blocks, -0.4, 0.4)), 0.7) << "negative control: blocks know no change of rate";
  }
}

/// The three phase frames of mode M are centred a sixth of an interval after mid-burst, so what its rate is off by
/// shows in its depth. At the image's border no window tells the slope that the rate follows from.
TEST(RigidMotion, reaches_to_the_border_of_the_image) {
  MovingBall ball{test::micro_rig(480, 360), {0.060, 0, 0}, Vector3d::Zero()};
  ball.radius_mm = 12, ball.centre_mm = {0.2, 0.1, 58.5};
  const DecodedBurst found = decode(ball.rig, ball.render(false), 2), blocks = decode(ball.rig, ball.render(false), 0);
  ASSERT_TRUE(found.diagnostics.rigid.moved);
  constexpr int kStrip = 8;
  for (const int begin : {0, 480 - kStrip}) {
    const double error_um = ball.strip_error_um(found, begin, begin + kStrip);
    EXPECT_LT(std::abs(error_um), 0.6 * std::abs(ball.strip_error_um(blocks, begin, begin + kStrip)))
        << "control: each block's motion by itself; found " << error_um << " um";
  }
}

/// What darkens a nearly flat wall towards the image's border is the lenses', and does not slide by with the wall's
/// texture. Taken for texture it tilts the wall.
TEST(RigidMotion, leaves_what_the_lenses_darken_with_the_pixel) {
  MovingBall wall{test::cropped_rig(640, 480), {0.080, 0, 0}, Vector3d::Zero()};
  wall.radius_mm = 300, wall.centre_mm = {0, 0, 349};
  MovingBall even = wall;
  even.lens = false;
  const auto tilt_um = [](const MovingBall& scene) {
    const DecodedBurst found = decode(scene.rig, scene.render(false), 2);
    EXPECT_TRUE(found.diagnostics.rigid.moved);
    const int width = scene.rig.camera.width, strip = width / 6;
    return scene.strip_error_um(found, width - 2 * strip, width - strip) -
           scene.strip_error_um(found, strip, 2 * strip);
  };
  EXPECT_LT(std::abs(tilt_um(wall)), 0.03);
  EXPECT_GT(std::abs(tilt_um(even)), 0.08) << "negative control: lenses that do not darken";
}

TEST(RigidMotion, tells_the_projectors_harmonic_from_light_that_slides_by) {
  MovingBall ball{test::cropped_rig(480, 360), {0.040, 0, 0}, Vector3d::Zero(), 0.01};
  ball.texture = 0.3;
  const auto burst = ball.render(false);
  const DecodedBurst found = decode(ball.rig, burst, 2), blocks = decode(ball.rig, burst, 0);
  ASSERT_TRUE(found.diagnostics.rigid.moved);
  EXPECT_NEAR(found.diagnostics.harmonic, ball.harmonic, 0.0005);
  EXPECT_GT(std::abs(static_cast<double>(blocks.diagnostics.harmonic) - ball.harmonic), 0.001)
      << "negative control: blocks that know no light";
}

TEST_P(RigidMotionOf, leaves_a_still_burst_alone) {
  const MovingBall ball{rig(), Vector3d::Zero(), Vector3d::Zero()};
  const auto burst = ball.render(true);
  const DecodedBurst found = decode(ball.rig, burst, 2), blocks = decode(ball.rig, burst, 0);
  EXPECT_FALSE(found.diagnostics.rigid.moved);
  EXPECT_EQ(found.phase_rad.pixels().size(), blocks.phase_rad.pixels().size());
  EXPECT_DOUBLE_EQ(ball.sigma_um(found), ball.sigma_um(blocks));
}

/// Blocks at the border of what is lit know little; what they scatter by is no motion.
TEST(RigidMotion, noise_of_small_blocks_is_no_motion) {
  test::Normals normal(5);
  std::vector<float> rates, sigmas, sure;
  for (int k = 0; k < 60; ++k) {
    sigmas.push_back(k % 4 == 0 ? 0.0005F : 0.004F);
    rates.push_back(sigmas.back() * static_cast<float>(normal()));
    sure.push_back(0.0005F);
  }
  const float negligible_rad = RigidMotionConfig().negligible_rad;
  EXPECT_TRUE(stands_still(rates, sigmas, negligible_rad));
  EXPECT_FALSE(stands_still(rates, sure, negligible_rad)) << "negative control: the same, were they sure of it";
  for (float& rate : rates) rate += 0.012F;
  EXPECT_FALSE(stands_still(rates, sigmas, negligible_rad));
  EXPECT_FALSE(stands_still(rates, std::vector<float>(rates.size(), 0.03F), negligible_rad)) << "no block tells";
}

/// A plane before which specks 1 mm nearer pass in the code frame alone: pixels left out there, and elsewhere.
struct Torn {
  std::size_t asked = 0, specks = 0, elsewhere = 0;
};
Torn count_torn(float torn_sigmas) {
  constexpr int kWidth = 400, kHeight = 120, kMargin_px = 8;
  const auto is_speck = [](int u, int v) { return u % 20 == 10 && v % 4 == 2; };
  const calib::Rig rig = test::micro_rig(kWidth, kHeight);
  test::SceneOptions o;
  o.noise = true;
  auto burst = test::render(rig, test::flat(48), o);
  const auto passing = test::render(rig, test::flat(47), o);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const auto i = static_cast<std::size_t>(v * kWidth + u);
      if (is_speck(u, v)) burst.frames.frames[1][i] = passing.frames.frames[1][i];
    }
  }
  DecodeConfig config;
  config.micro.refit.torn_sigmas = torn_sigmas;
  const DecodedBurst found = BurstDecoder::make(rig, config).value().decode(burst.frames.view());
  EXPECT_TRUE(found.accepted());
  Torn out;
  for (int v = kMargin_px; v < kHeight - kMargin_px; ++v) {
    for (int u = kMargin_px; u < kWidth - kMargin_px; ++u) {
      const std::size_t left_out = found.reject(u, v) == PixelReject::kEdge ? 1U : 0U;
      out.asked += is_speck(u, v) ? 1U : 0U;
      (is_speck(u, v) ? out.specks : out.elsewhere) += left_out;
    }
  }
  return out;
}

TEST(TornPixels, whose_code_frame_saw_another_surface_are_left_out) {
  const Torn with = count_torn(MicroRefitConfig{}.torn_sigmas), without = count_torn(1e6F);
  EXPECT_GT(2 * with.specks, with.asked) << "the code of some happens to be the same";
  EXPECT_LT(with.elsewhere, 10U);
  EXPECT_EQ(without.specks, 0U) << "negative control: three frames alone do not show it";
}

}  // namespace
}  // namespace enamel::pipeline
