// Scenes that break phase unwrapping. What counts: no pixel with a wrong fringe order; what cannot be known is
// rejected.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/decode/unwrap/cells.hpp"
#include "pipeline/decode/unwrap/flood.hpp"
#include "tests/unit/decode/decoded_scene.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

using test::DecodedScene;

DecodedScene decode(const calib::Rig& rig, const test::Depth& depth, const test::SceneOptions& o,
                    const DecodeConfig& config = {}) {
  return test::decode_scene(BurstDecoder::make(rig, config).value(), rig, depth, o);
}

TEST(Unwrap, plane_is_whole) {
  const DecodedScene r = decode(test::cropped_rig(320, 120), test::flat(48), test::with_noise());
  EXPECT_EQ(r.wrong, 0U);
  EXPECT_GE(static_cast<double>(r.valid), 0.99 * static_cast<double>(r.lit));
}

TEST(Unwrap, weak_modulation_stays_right) {
  test::SceneOptions o = test::with_noise();
  o.mean_dn = 60;
  o.modulation_dn = 13;  // sigma of three frames up to 0.12 rad, the mask's limit is 0.15
  const DecodedScene r = decode(test::cropped_rig(320, 120), test::flat(50), o);
  EXPECT_EQ(r.wrong, 0U);
  EXPECT_GE(static_cast<double>(r.valid), 0.9 * static_cast<double>(r.lit));
}

/// Phi of a facing plane.
double phase_at(const calib::Rig& rig, int u, int v, double z_mm) {
  const auto ray = calib::undistort(rig.camera, {static_cast<double>(u), static_cast<double>(v)});
  return 2 * std::numbers::pi * calib::project_to_projector(rig, ray, z_mm).x / rig.patterns.period_px;
}

TEST(Unwrap, gaps_between_teeth_do_not_tear_the_far_side_off) {
  const calib::Rig rig = test::cropped_rig(400, 120);
  constexpr int kBegin = 191, kEnd = 215;
  for (const double deep_mm : {0.3, 1.0, 2.0}) {
    const auto in_gap = [](int u) { return u >= kBegin && u < kEnd; };
    test::SceneOptions o = test::with_noise();
    o.light = [&](int u, int v) {  // the tooth behind the gap casts its shadow into it
      return in_gap(u) && phase_at(rig, u, v, 47 + deep_mm) >= phase_at(rig, kEnd, v, 47) ? 0.0 : 1.0;
    };
    const DecodedScene r = decode(
        rig, [&](int u, int) { return in_gap(u) ? 47 + deep_mm : 47.0; }, o);
    EXPECT_EQ(r.wrong, 0U) << deep_mm;
    EXPECT_GE(static_cast<double>(r.valid), 0.85 * static_cast<double>(r.lit)) << deep_mm;
  }
}

TEST(Unwrap, jump_of_exactly_one_fringe_along_the_fringes_is_found_by_the_code) {
  const calib::Rig rig = test::cropped_rig(320, 160);
  const double jump = test::fringe_jump_mm(rig, 50);
  const DecodedScene r = decode(
      rig, [&](int, int v) { return v < 80 ? 50.0 : 50 - jump; }, test::with_noise());
  EXPECT_LE(r.wrong, 320U);  // at most the row of the jump itself
  EXPECT_GE(static_cast<double>(r.valid), 0.9 * static_cast<double>(r.lit));
}

TEST(Unwrap, jump_of_exactly_one_fringe_across_the_fringes_is_found_by_the_code) {
  const calib::Rig rig = test::cropped_rig(400, 100);
  const double jump = test::fringe_jump_mm(rig, 50);
  const DecodedScene r = decode(
      rig, [&](int u, int) { return u < 200 ? 50.0 : 50 - jump; }, test::with_noise());
  EXPECT_LE(static_cast<double>(r.wrong), 0.01 * static_cast<double>(r.lit));
  EXPECT_GE(static_cast<double>(r.valid), 0.8 * static_cast<double>(r.lit));
}

TEST(Unwrap, code_is_trusted_to_the_border_of_the_picture_and_not_to_the_end_of_a_run) {
  std::vector<Segment> segments(2);
  segments[0].begin = 0, segments[0].end = 20;
  segments[1].begin = 30, segments[1].end = 50;
  EXPECT_EQ(core_of(segments, 0, 2, 50).begin, 0);
  EXPECT_EQ(core_of(segments, 0, 2, 50).end, 18);
  EXPECT_EQ(core_of(segments, 1, 2, 50).begin, 32);
  EXPECT_EQ(core_of(segments, 1, 2, 50).end, 50);
  EXPECT_EQ(core_of(segments, 1, 2, 51).end, 48);
}

TEST(Unwrap, isolated_patch_with_enough_code_is_placed) {
  test::SceneOptions o = test::with_noise();
  o.light = [](int u, int v) { return u > 100 && u < 200 && v > 40 && v < 80 ? 1.0 : 0.0; };
  const DecodedScene r = decode(test::cropped_rig(320, 120), test::flat(44), o);
  EXPECT_EQ(r.wrong, 0U);
  EXPECT_GE(static_cast<double>(r.valid), 0.8 * static_cast<double>(r.lit));
}

TEST(Unwrap, patch_of_half_a_fringe_is_rejected_as_undecided_not_guessed) {
  test::SceneOptions o = test::with_noise();
  o.light = [](int u, int v) { return (u < 200 || (u > 250 && u < 261 && v > 50 && v < 61)) ? 1.0 : 0.0; };
  const DecodedScene r = decode(test::cropped_rig(320, 120), test::flat(44), o);
  EXPECT_EQ(r.wrong, 0U);
  for (int v = 51; v < 61; ++v)
    for (int u = 251; u < 261; ++u) ASSERT_TRUE(std::isnan(r.burst.patch.depth_mm(u, v))) << u << "," << v;
  EXPECT_GT(r.burst.counts[static_cast<std::size_t>(PixelReject::kRelative)], 20U);
}

/// A rib of a fringe's width stands 3 mm before a plane, alone in the dark but for the shadow that it casts there.
DecodedScene decode_rib(int first, const DecodeConfig& config) {
  const calib::Rig rig = test::cropped_rig(400, 60);
  constexpr int kWidth = 27;
  test::SceneOptions o = test::with_noise();
  o.light = [=](int u, int v) {
    if (u >= first) return u < first + kWidth ? 1.0 : 0.0;
    return phase_at(rig, u, v, 50) < phase_at(rig, first, v, 47) ? 1.0 : 0.0;
  };
  return decode(
      rig, [=](int u, int) { return u >= first ? 47.0 : 50.0; }, o, config);
}

/// Pixels of twelve ribs that stay undecided; none may be wrong.
std::size_t undecided_ribs(const DecodeConfig& config) {
  std::size_t open = 0;
  for (int first = 240; first < 348; first += 9) {
    const DecodedScene r = decode_rib(first, config);
    EXPECT_EQ(r.wrong, 0U) << first;
    open += r.burst.counts[static_cast<std::size_t>(PixelReject::kRelative)];
  }
  return open;
}

/// Knows nothing of where light goes: two signs of the code are not enough for every rib.
DecodeConfig blind_to_light() {
  DecodeConfig c;
  c.order.fold_cost = c.order.missed_contact_cost = c.order.lit_twice_cost = 0;
  return c;
}

TEST(Unwrap, both_ends_of_a_shadow_lie_on_one_ray_of_light) {
  const DecodeConfig blind = blind_to_light();
  DecodeConfig seeing = blind;
  seeing.order.fold_cost = DecodeConfig{}.order.fold_cost;
  seeing.order.missed_contact_cost = DecodeConfig{}.order.missed_contact_cost;
  const std::size_t without = undecided_ribs(blind);
  EXPECT_GT(without, 2000U);
  EXPECT_LT(undecided_ribs(seeing), without / 4);
}

TEST(Unwrap, no_column_of_the_projector_lights_two_places_of_a_row) {
  const DecodeConfig blind = blind_to_light();
  DecodeConfig seeing = blind;
  seeing.order.lit_twice_cost = DecodeConfig{}.order.lit_twice_cost;
  EXPECT_LT(undecided_ribs(seeing), undecided_ribs(blind) / 2);
}

TEST(Unwrap, pixels_beside_a_sharp_step_are_measured_and_mixed_ones_are_not) {
  const calib::Rig rig = test::cropped_rig(320, 200);
  const auto depth = [](int u, int) { return u < 160 ? 49.0 : 48.0; };
  auto scene = test::render(rig, depth, test::with_noise());
  const BurstDecoder decoder = BurstDecoder::make(rig).value();
  const auto measured = [&](int column) {
    const DecodedBurst burst = decoder.decode(scene.frames.view());
    int count = 0;
    for (int v = 0; v < 200; ++v) {
      const auto z = static_cast<double>(burst.patch.depth_mm(column, v));
      if (std::isnan(z)) continue;
      ++count;
      EXPECT_LT(std::min(std::abs(z - 49), std::abs(z - 48)), 0.15) << column << ',' << v;
    }
    return count;
  };
  EXPECT_GT(measured(159), 180);
  EXPECT_GT(measured(160), 180);
  for (auto& frame : scene.frames.frames) {
    for (std::size_t row = 0; row < 200; ++row) {
      const std::size_t i = row * 320 + 160;
      frame[i] = static_cast<std::uint8_t>((frame[i - 1] + frame[i + 1]) / 2);
    }
  }
  EXPECT_LT(measured(160), 20);
}

TEST(Unwrap, surface_that_leaves_the_depth_range_is_not_folded_back_into_it) {
  const DecodedScene r = decode(
      test::cropped_rig(400, 100), [](int u, int) { return 52 + 0.02 * u; }, test::with_noise());
  EXPECT_EQ(r.wrong, 0U);
  EXPECT_GT(r.burst.counts[static_cast<std::size_t>(PixelReject::kOutOfRange)], 5000U);
}

}  // namespace
}  // namespace enamel::pipeline
