// Four steps without a code: what hangs together is told, and placed where the depth range leaves one order.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/unit/decode/decoded_scene.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

TEST(PlainFrames, without_polarity_code_nothing_is_placed) {
  calib::Rig rig = test::cropped_rig(320, 120);
  rig.patterns.mode = calib::PatternMode::kPlain4;
  rig.patterns.polarity_code.clear();
  const test::DecodedScene r =
      test::decode_scene(BurstDecoder::make(rig).value(), rig, test::flat(48), test::with_noise());
  EXPECT_EQ(r.burst.verdict, BurstVerdict::kNoCode);
  EXPECT_EQ(r.valid, 0U);
}

TEST(PlainFrames, plain_frames_are_placed_when_the_depth_range_allows_one_order_only) {
  calib::Rig rig = test::cropped_rig(320, 120);
  rig.patterns.mode = calib::PatternMode::kPlain4;
  rig.patterns.polarity_code.clear();
  rig.depth_range = calib::DepthRange{47.5, 48.5};
  const test::DecodedScene r =
      test::decode_scene(BurstDecoder::make(rig).value(), rig, test::flat(48), test::with_noise());
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
      rig, [&](int u, int v) { return 50 - fringe_mm * height(u, v); }, test::with_noise());
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

TEST(PlainFrames, frames_without_a_code_hang_together_in_regions) {
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

TEST(PlainFrames, a_flood_would_leak_through_that_cliff) {  // the control
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
