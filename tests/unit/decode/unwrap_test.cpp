// Scenes that break phase unwrapping. What counts: no pixel with a wrong fringe order; what cannot be known is
// rejected.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/decode/unwrap/cells.hpp"
#include "pipeline/decode/unwrap/flood.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

struct Outcome {
  std::size_t valid = 0, wrong = 0, lit = 0;
  DecodedBurst burst;
};

Outcome decode(const calib::Rig& rig, const std::function<double(int, int)>& depth, const test::SceneOptions& o,
               const DecodeConfig& config = {}) {
  const auto scene = test::render(rig, depth, o);
  const BurstDecoder decoder = BurstDecoder::make(rig, config).value();
  Outcome out;
  out.burst = decoder.decode(scene.frames.view());
  for (int v = 0; v < rig.camera.height; ++v) {
    for (int u = 0; u < rig.camera.width; ++u) {
      out.lit += o.light(u, v) > 0 ? 1U : 0U;
      const auto z = static_cast<double>(out.burst.patch.depth_mm(u, v));
      if (std::isnan(z)) continue;
      ++out.valid;
      out.wrong += std::abs(z - scene.depth_mm(u, v)) > 1.0 ? 1U : 0U;  // a wrong order is 3.5 mm off
    }
  }
  return out;
}

test::SceneOptions noisy() {
  test::SceneOptions o;
  o.noise = true;
  return o;
}

TEST(Unwrap, plane_is_whole) {
  const Outcome r = decode(test::cropped_rig(320, 120), test::flat(48), noisy());
  EXPECT_EQ(r.wrong, 0U);
  EXPECT_GE(static_cast<double>(r.valid), 0.99 * static_cast<double>(r.lit));
}

TEST(Unwrap, weak_modulation_stays_right) {
  test::SceneOptions o = noisy();
  o.mean_dn = 60;
  o.modulation_dn = 13;  // sigma of three frames up to 0.12 rad, the mask's limit is 0.15
  const Outcome r = decode(test::cropped_rig(320, 120), test::flat(50), o);
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
    test::SceneOptions o = noisy();
    o.light = [&](int u, int v) {  // the tooth behind the gap casts its shadow into it
      return in_gap(u) && phase_at(rig, u, v, 47 + deep_mm) >= phase_at(rig, kEnd, v, 47) ? 0.0 : 1.0;
    };
    const Outcome r = decode(
        rig, [&](int u, int) { return in_gap(u) ? 47 + deep_mm : 47.0; }, o);
    EXPECT_EQ(r.wrong, 0U) << deep_mm;
    EXPECT_GE(static_cast<double>(r.valid), 0.85 * static_cast<double>(r.lit)) << deep_mm;
  }
}

TEST(Unwrap, jump_of_exactly_one_fringe_along_the_fringes_is_found_by_the_code) {
  const calib::Rig rig = test::cropped_rig(320, 160);
  const double jump = test::fringe_jump_mm(rig, 50);
  const Outcome r = decode(
      rig, [&](int, int v) { return v < 80 ? 50.0 : 50 - jump; }, noisy());
  EXPECT_LE(r.wrong, 320U);  // at most the row of the jump itself
  EXPECT_GE(static_cast<double>(r.valid), 0.9 * static_cast<double>(r.lit));
}

TEST(Unwrap, jump_of_exactly_one_fringe_across_the_fringes_is_found_by_the_code) {
  const calib::Rig rig = test::cropped_rig(400, 100);
  const double jump = test::fringe_jump_mm(rig, 50);
  const Outcome r = decode(
      rig, [&](int u, int) { return u < 200 ? 50.0 : 50 - jump; }, noisy());
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
  test::SceneOptions o = noisy();
  o.light = [](int u, int v) { return u > 100 && u < 200 && v > 40 && v < 80 ? 1.0 : 0.0; };
  const Outcome r = decode(test::cropped_rig(320, 120), test::flat(44), o);
  EXPECT_EQ(r.wrong, 0U);
  EXPECT_GE(static_cast<double>(r.valid), 0.8 * static_cast<double>(r.lit));
}

TEST(Unwrap, patch_of_half_a_fringe_is_rejected_as_undecided_not_guessed) {
  test::SceneOptions o = noisy();
  o.light = [](int u, int v) { return (u < 200 || (u > 250 && u < 261 && v > 50 && v < 61)) ? 1.0 : 0.0; };
  const Outcome r = decode(test::cropped_rig(320, 120), test::flat(44), o);
  EXPECT_EQ(r.wrong, 0U);
  for (int v = 51; v < 61; ++v)
    for (int u = 251; u < 261; ++u) ASSERT_TRUE(std::isnan(r.burst.patch.depth_mm(u, v))) << u << "," << v;
  EXPECT_GT(r.burst.counts[static_cast<std::size_t>(PixelReject::kRelative)], 20U);
}

/// A rib of a fringe's width stands 3 mm before a plane, alone in the dark but for the shadow that it casts there.
Outcome decode_rib(int first, const DecodeConfig& config) {
  const calib::Rig rig = test::cropped_rig(400, 60);
  constexpr int kWidth = 27;
  test::SceneOptions o = noisy();
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
    const Outcome r = decode_rib(first, config);
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
  auto scene = test::render(rig, depth, noisy());
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
  const Outcome r = decode(
      test::cropped_rig(400, 100), [](int u, int) { return 52 + 0.02 * u; }, noisy());
  EXPECT_EQ(r.wrong, 0U);
  EXPECT_GT(r.burst.counts[static_cast<std::size_t>(PixelReject::kOutOfRange)], 5000U);
}

TEST(Unwrap, without_polarity_code_nothing_is_placed) {
  calib::Rig rig = test::cropped_rig(320, 120);
  rig.patterns.mode = calib::PatternMode::kPlain4;
  rig.patterns.polarity_code.clear();
  const Outcome r = decode(rig, test::flat(48), noisy());
  EXPECT_EQ(r.burst.verdict, BurstVerdict::kNoCode);
  EXPECT_EQ(r.valid, 0U);
}

TEST(Unwrap, plain_frames_are_placed_when_the_depth_range_allows_one_order_only) {
  calib::Rig rig = test::cropped_rig(320, 120);
  rig.patterns.mode = calib::PatternMode::kPlain4;
  rig.patterns.polarity_code.clear();
  rig.depth_range = calib::DepthRange{47.5, 48.5};
  const Outcome r = decode(rig, test::flat(48), noisy());
  EXPECT_EQ(r.wrong, 0U);
  EXPECT_GE(static_cast<double>(r.valid), 0.95 * static_cast<double>(r.lit));
}

/// A cliff that grows from nothing to 1.6 fringes and back: in two places its jump is a whole fringe, which neighbours
/// do not see.
calib::Rig plain_rig() {
  calib::Rig rig = test::cropped_rig(320, 200);
  rig.patterns.mode = calib::PatternMode::kPlain4;
  rig.patterns.polarity_code.clear();
  return rig;
}

test::SyntheticBurst render_cliff(const calib::Rig& rig) {
  const double fringe_mm = test::fringe_jump_mm(rig, 50);
  const auto height = [](int u, int v) {
    if (u < 160 || v < 50 || v > 150) return 0.0;
    return 1.6 * std::sin(std::numbers::pi * (v - 50) / 100.0) * std::max(0.0, 1 - (u - 160) / 140.0);
  };
  return test::render(
      rig, [&](int u, int v) { return 50 - fringe_mm * height(u, v); }, noisy());
}

/// Pixels by the number of fringes that they lie off; all but the most frequent one's are wrong.
struct Offsets {
  std::map<long, std::size_t> pixels;

  void add(double true_rad, double phi_rad) { ++pixels[std::lround((true_rad - phi_rad) / (2 * std::numbers::pi))]; }
  [[nodiscard]] std::size_t wrong() const {
    std::size_t all = 0, most = 0;
    for (const auto& [k, n] : pixels) all += n, most = std::max(most, n);
    return all - most;
  }
};

TEST(Unwrap, frames_without_a_code_hang_together_in_regions) {
  const calib::Rig rig = plain_rig();
  const auto scene = render_cliff(rig);
  const DecodedBurst found = BurstDecoder::make(rig).value().decode(scene.frames.view());
  EXPECT_EQ(found.verdict, BurstVerdict::kNoCode);
  std::map<std::int32_t, Offsets> regions;
  std::size_t n = 0, wrong = 0;
  for (const auto& span : found.relative.spans) {
    for (std::int32_t u = span.begin; u < span.end; ++u, ++n) {
      const double turns = 2 * std::numbers::pi * span.wraps;
      regions[span.region].add(scene.phase_rad(u, span.row), static_cast<double>(found.relative.phase_rad[n]) + turns);
    }
  }
  for (const auto& [region, offsets] : regions) wrong += offsets.wrong();
  EXPECT_GT(n, 320U * 200U * 9 / 10);
  EXPECT_EQ(n, found.relative.sigma_rad.size());
  EXPECT_EQ(wrong, 0U);
}

TEST(Unwrap, a_flood_would_leak_through_that_cliff) {  // the control
  const calib::Rig rig = plain_rig();
  const auto scene = render_cliff(rig);
  const RayDepth rays = RayDepth::bake(rig, *rig.depth_range).value();
  PhaseMaps phase;
  LinkMaps links;
  FloodMaps flooded;
  compute_phase(scene.frames.view(), noise_from_rig(*rig.noise, 8), {}, phase);
  compute_links(phase, {rays.phase_mid_rad.data(), 0.23F, 0.23F}, {}, links);
  reject_edges(links, phase);
  flood(phase.phase_rad, links, flooded);
  std::map<std::int32_t, Offsets> components;
  for (std::size_t i = 0; i < phase.phase_rad.size(); ++i) {
    const double turns = 2 * std::numbers::pi * flooded.wraps[i];
    if (flooded.component[i] >= 0)
      components[flooded.component[i]].add(scene.phase_rad[i], static_cast<double>(phase.phase_rad[i]) + turns);
  }
  std::size_t wrong = 0;
  for (const auto& [component, offsets] : components) wrong += offsets.wrong();
  EXPECT_GT(wrong, 1000U);
}

}  // namespace
}  // namespace enamel::pipeline
