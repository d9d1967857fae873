// Mode M from frames to depth.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/unit/decode/decoded_scene.hpp"
#include "tests/unit/decode/mode_m/micro_scene.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

using test::DecodedScene;
using test::decoder;
using test::Depth;
using test::figures;
using test::kSlant;
using test::kStairs;
using test::noisy;
using test::wide_rig;

DecodedScene decode(const Depth& depth, const test::SceneOptions& o, const BurstDecoder& by = decoder(),
                    const calib::Rig& rig = wide_rig()) {
  return test::decode_scene(by, rig, depth, o);
}

TEST(MicroDecoder, plane_is_whole_right_and_as_noisy_as_predicted) {
  for (const double modulation : {8.0, 20.0, 50.0, 90.0}) {
    const DecodedScene r = decode(test::flat(48), noisy(modulation));
    ASSERT_TRUE(r.burst.accepted()) << modulation << " " << name_of(r.burst.verdict);
    EXPECT_EQ(r.wrong, 0U) << modulation;
    EXPECT_GE(r.coverage(), 0.98) << modulation;
    EXPECT_NEAR(r.scatter_to_sigma(), 1.0, 0.05) << modulation;
  }
}

TEST(MicroDecoder, stairs_are_placed_or_rejected_not_guessed) {
  for (const double modulation : {20.0, 80.0}) {
    const DecodedScene r = decode(kStairs, noisy(modulation));
    ASSERT_TRUE(r.burst.accepted()) << modulation;
    EXPECT_LE(r.wrong_share(), 0.0005) << modulation;
    EXPECT_GE(r.coverage(), 0.85) << modulation;
  }
}

TEST(MicroDecoder, jumps_of_exactly_one_fringe_are_found_by_the_code) {
  const double jump = test::fringe_jump_mm(wide_rig(), 50);
  const DecodedScene across = decode([&](int u, int) { return u < 200 ? 50.0 : 50 - jump; }, noisy());
  EXPECT_LE(across.wrong_share(), 0.01);
  EXPECT_GE(across.coverage(), 0.9);
  const DecodedScene along = decode([&](int, int v) { return v < 60 ? 50.0 : 50 - jump; }, noisy());
  EXPECT_LE(along.wrong, 400U);  // at most the row of the jump itself
  EXPECT_GE(along.coverage(), 0.9);
}

TEST(MicroDecoder, pixels_beside_a_jump_that_the_phase_does_not_show_are_edges) {
  const auto edges = [](const DecodedScene& o) { return o.burst.counts[static_cast<std::size_t>(PixelReject::kEdge)]; };
  const double jump = test::fringe_jump_mm(wide_rig(), 50);
  const auto height = static_cast<std::size_t>(wide_rig().camera.height);
  EXPECT_GE(edges(decode([&](int u, int) { return u < 200 ? 50.0 : 50 - jump; }, noisy())), 3 * height);
  EXPECT_EQ(edges(decode([](int, int) { return 50.0; }, noisy())), 0U);
}

TEST(MicroDecoder, small_isolated_patch_is_placed_where_the_polarity_code_gives_up) {
  test::SceneOptions o = noisy();
  o.light = [](int u, int v) { return (u < 200 || (u > 250 && u < 271 && v > 50 && v < 66)) ? 1.0 : 0.0; };
  const DecodedScene r = decode(test::flat(44), o);
  EXPECT_EQ(r.wrong, 0U);
  int placed = 0;
  for (int v = 51; v < 66; ++v)
    for (int u = 251; u < 271; ++u) placed += std::isnan(r.burst.patch.depth_mm(u, v)) ? 0 : 1;
  EXPECT_GT(placed, 200);
}

TEST(MicroDecoder, surface_that_leaves_the_depth_range_is_not_folded_back_into_it) {
  const DecodedScene r = decode([](int u, int) { return 52 + 0.02 * u; }, noisy());
  EXPECT_EQ(r.wrong, 0U);
  EXPECT_GT(r.burst.counts[static_cast<std::size_t>(PixelReject::kOutOfRange)], 5000U);
}

/// A code that repeats with the K = 5 orders of the range, so that the first order beyond looks like the first within.
DecodedScene decode_by_tight_code(const Depth& depth, const DecodeConfig& config = {}) {
  const calib::Rig rig = test::micro_rig(400, 120, 5);
  return decode(depth, noisy(), BurstDecoder::make(rig, config).value(), rig);
}

TEST(MicroDecoder, surface_is_followed_beyond_the_range_where_the_code_repeats) {
  const Depth sinking = [](int, int v) { return 52 + 0.06 * v; };
  const DecodedScene r = decode_by_tight_code(sinking);
  EXPECT_EQ(r.wrong, 0U);
  EXPECT_GT(r.burst.counts[static_cast<std::size_t>(PixelReject::kOutOfRange)], 10000U);
  EXPECT_GT(r.burst.patch.valid_px, 20000U);
  DecodeConfig strict;
  strict.order.beyond_range_cost = 15;
  EXPECT_GT(decode_by_tight_code(sinking, strict).wrong, 1000U) << "negative control: the range as a law";
}

TEST(MicroDecoder, surface_that_stands_alone_lies_within_the_range_where_the_code_repeats) {
  for (const double z : {41.0, 55.0}) {
    const DecodedScene r = decode_by_tight_code(test::flat(z));
    EXPECT_EQ(r.wrong, 0U) << z;
    EXPECT_GT(r.burst.patch.valid_px, 40000U) << z;
  }
}

/// Its light still reaches the camera. The range holds orders 11 to 15 of a pixel here, this surface has 17, which at
/// L = 6 looks like 11.
TEST(MicroDecoder, surface_two_fringes_beyond_the_range_is_told_from_one_at_its_near_end) {
  const auto folded = [](double ratio) {
    const calib::Rig rig = test::micro_rig(400, 120, ratio);
    const DecodedBurst b =
        BurstDecoder::make(rig).value().decode(test::render(rig, test::flat(64), noisy()).frames.view());
    return b.patch.valid_px;
  };
  EXPECT_EQ(folded(test::kShippedRatio), 0U);
  EXPECT_GT(folded(test::kDesignRatio), 1000U) << "negative control";
}

TEST(MicroDecoder, motion_turns_the_code_and_leaves_the_orders_right) {
  for (const double motion : {-0.3, -0.2, -0.1, 0.1, 0.2, 0.3}) {
    test::SceneOptions o = noisy();
    o.motion_rad = motion;
    const DecodedScene r = decode(kStairs, o);
    ASSERT_TRUE(r.burst.accepted()) << motion << " turn " << r.burst.diagnostics.code_turn_rad;
    EXPECT_LE(r.wrong_share(), 0.0005) << motion;
    EXPECT_NEAR(r.burst.diagnostics.motion_rad, motion, 0.01);
    EXPECT_LT(r.burst.diagnostics.odd_shift_rad, 0.08F)  // third order at 0.3 rad
        << motion << figures(r.burst);
    // Slot 1 lies 2/3 of an interval before the mean of the slots 0, 2, 3. Beyond 0.2 rad many segments are placed only
    // after that is taken off.
    if (std::abs(motion) > 0.25) continue;
    EXPECT_NEAR(r.burst.diagnostics.code_turn_rad, -7.0 / 6 * 2 / 3 * motion, 0.02) << motion;
  }
}

/// A plane of uneven brightness that passes by along the fringes, by so many px a frame: its phase stays, its light
/// does not.
DecodedBurst painted_plane_passing(double px_per_frame, const BurstDecoder& by) {
  const test::FrameSet frames = test::frames_in_motion([&](double tau) {
    test::SceneOptions o = noisy();
    o.light = [&](int u, int v) {
      const double at_px = v + tau * px_per_frame;
      return 0.75 + 0.12 * std::sin(at_px / 20.0) + 0.12 * std::sin(u / 25.0 + at_px / 40.0);
    };
    return test::render(wide_rig(), test::flat(48), o);
  });
  return by.decode(frames.view());
}

TEST(MicroDecoder, orders_are_found_where_the_light_of_a_painted_surface_passes_by) {
  const DecodedBurst burst = painted_plane_passing(14, decoder());
  ASSERT_TRUE(burst.accepted()) << name_of(burst.verdict) << " " << burst.diagnostics.code_agreement;
  EXPECT_GT(burst.diagnostics.code_agreement, 0.97);
  DecodeConfig once;
  once.micro.motion.clear_agreement = 0;
  const DecodedBurst blind = painted_plane_passing(14, BurstDecoder::make(wide_rig(), once).value());
  // Negative control: every block's motion by itself leaves more than twice as many codes in doubt.
  EXPECT_GT(1 - blind.diagnostics.code_agreement, 2 * (1 - burst.diagnostics.code_agreement)) << figures(blind);
}

/// A roof before a probe that turns about the middle of its range by 0.018 rad a frame: the phase moves each way, and
/// the far end of the roof lies beyond the range.
struct TurningRoof {
  calib::Rig rig = test::micro_rig(240, 480);

  /// Through (0, 0, 50), tilted by 52 degrees at mid-burst, turned about (0, 0, 46.7).
  [[nodiscard]] double depth(int u, int v, double tau) const {
    constexpr double kTilt_rad = 0.9, kTurn_rad = 0.018, kAbout_mm = 46.7, kAt_mm = 50;
    const double turn = kTurn_rad * tau, tilt = kTilt_rad + turn, lever = kAt_mm - kAbout_mm;
    const double y_mm = -std::sin(turn) * lever, z_mm = kAbout_mm + std::cos(turn) * lever;
    const double y = calib::undistort(rig.camera, {static_cast<double>(u), static_cast<double>(v)}).y;
    const double n_y = std::sin(tilt), n_z = std::cos(tilt);
    return (n_y * y_mm + n_z * z_mm) / (n_y * y + n_z);
  }

  [[nodiscard]] DecodedBurst decoded(const DecodeConfig& config) const {
    const test::FrameSet frames = test::frames_in_motion([&](double tau) {
      return test::render(
          rig, [&](int u, int v) { return depth(u, v, tau); }, noisy());
    });
    return BurstDecoder::make(rig, config).value().decode(frames.view());
  }

  [[nodiscard]] std::size_t wrong(const DecodedBurst& burst) const {
    std::size_t n = 0;
    for (int v = 0; v < rig.camera.height; ++v) {
      for (int u = 0; u < rig.camera.width; ++u)
        n += std::abs(static_cast<double>(burst.patch.depth_mm(u, v)) - depth(u, v, 0)) > 1 ? 1U : 0U;
    }
    return n;
  }
};

TEST(MicroDecoder, orders_are_found_where_a_turn_moves_the_phase_each_way) {
  const TurningRoof roof;
  const DecodedBurst burst = roof.decoded({});
  ASSERT_TRUE(burst.accepted()) << figures(burst);
  EXPECT_GT(burst.diagnostics.code_agreement, 0.98);
  EXPECT_EQ(roof.wrong(burst), 0U);
  DecodeConfig once;
  once.micro.motion.clear_agreement = 0;
  const DecodedBurst blind = roof.decoded(once);
  // Negative control: every block's motion by itself leaves more than twice as many codes in doubt.
  EXPECT_GT(1 - blind.diagnostics.code_agreement, 2 * (1 - burst.diagnostics.code_agreement)) << figures(blind);
}

TEST(MicroDecoder, second_harmonic_is_undone) {
  test::SceneOptions o;
  o.harmonic = 0.02;
  const DecodedScene r = decode(kSlant, o);
  ASSERT_TRUE(r.burst.accepted());
  EXPECT_NEAR(r.burst.diagnostics.third_rad, -0.02, 0.001);
  DecodeConfig raw;
  raw.correct_ripple = false;
  const DecodedScene plain = decode(kSlant, o, BurstDecoder::make(wide_rig(), raw).value());
  EXPECT_GT(plain.rms_um(), 7.0);  // the control: 0.02 rad / sqrt 2 is 8 um
  EXPECT_LT(r.rms_um(), 2.0);      // rounding to whole DN
}

TEST(MicroDecoder, reused_workspace_gives_the_bits_of_a_fresh_one) {
  const auto a = test::render(wide_rig(), test::flat(44), noisy());
  const auto b = test::render(wide_rig(), kStairs, noisy());
  DecodeWorkspace workspace;
  DecodedBurst reused;
  decoder().decode(a.frames.view(), workspace, reused);
  decoder().decode(b.frames.view(), workspace, reused);
  const DecodedBurst fresh = decoder().decode(b.frames.view());
  EXPECT_TRUE(std::equal(reused.reject.pixels().begin(), reused.reject.pixels().end(), fresh.reject.pixels().begin()));
  for (std::size_t i = 0; i < fresh.order.size(); ++i) {
    ASSERT_EQ(reused.order[i], fresh.order[i]);
    if (fresh.order[i] == kNoOrder) continue;
    ASSERT_EQ(reused.patch.depth_mm[i], fresh.patch.depth_mm[i]);
  }
}

}  // namespace
}  // namespace enamel::pipeline
