// Brightness that does not depend on distance, slope, exposure and veil, and the limit that parts teeth from gum.
#include <gtest/gtest.h>

#include "pipeline/tissue/shade_limit.hpp"
#include "pipeline/tissue/shade_of.hpp"
#include "tests/unit/tissue/lit_patch.hpp"

namespace enamel::tissue_test {
namespace {

using pipeline::ShadeHeaps;
using pipeline::ShadeLimit;

struct Scan {
  ShadeLimit limit;
  std::size_t cells[2] = {0, 0};  ///< that have a shade: of the left half, of the right
  std::size_t soft[2] = {0, 0};   ///< of these, called soft by the limit of all bursts
  ShadeHeaps heaps;
};

/// Bursts of a ball, its left half of one paint and its right half of another, from drawn places with drawn lamps that
/// differ in exposure alone.
Scan scan(const Paint& left, const Paint& right, std::uint64_t seed) {
  synthetic::Random random(seed);
  const calib::Rig rig = synthetic::small_rig();
  Scan out;
  Lamp lamp;
  lamp.dn_per_ms = 100 + 600 * random.uniform();
  lamp.noise = 0.01 + 0.04 * random.uniform();
  const double radius = 6 + 10 * random.uniform();
  std::vector<std::pair<ShadeMap, std::vector<int>>> seen;
  for (std::uint64_t n = 0; n < 3; ++n) {
    // One a line: compilers differ in the order of arguments, and seeds shall mean the same to all.
    const Vec3d target = 2 * random.vector();
    const Vec3d from = Vec3d(0, 0, 1) + 0.6 * random.vector();
    const double distance_mm = 42 + 12 * random.uniform();
    const double roll_rad = 6 * random.uniform();
    const Pose pose = synthetic::looking_at(target, from, distance_mm, roll_rad);
    SurfacePatch patch = render(rig, synthetic::sphere({0, 0, radius}, radius), pose);
    lamp.exposure_ms = 0.5 + 3 * random.uniform();
    lamp.veil_dn = 20 * random.uniform();
    lamp.seed = seed * 100 + n;
    paint(
        patch, pose, [&](const Vec3d& p) { return p.x() < 0 ? left : right; }, lamp);
    const ShadeMap shade = shade_of(patch, light_of(lamp));
    out.limit.add(shade);
    std::vector<int> side(shade.size(), -1);
    for (int j = 0; j < shade.height(); ++j) {
      for (int i = 0; i < shade.width(); ++i) {
        const Vec3f p = patch.points(i * kShadeCell_px + kShadeCell_px / 2, j * kShadeCell_px + kShadeCell_px / 2);
        if (!std::isfinite(p.x()) || shade(i, j) == kNoShade) continue;
        const Vec3d at = pose * p.cast<double>();
        if (std::abs(at.x()) > 0.5) side[shade.index(i, j)] = at.x() < 0 ? 0 : 1;
      }
    }
    seen.emplace_back(shade, side);
  }
  out.heaps = out.limit.heaps();
  for (const auto& [shade, side] : seen) {
    for (std::size_t k = 0; k < side.size(); ++k) {
      if (side[k] < 0) continue;
      const auto half = static_cast<std::size_t>(side[k]);
      ++out.cells[half];
      out.soft[half] += is_soft(shade[k], out.heaps.soft_below) ? 1U : 0U;
    }
  }
  return out;
}

TEST(Shade, parts_teeth_from_gum_whatever_light_distance_and_slope) {
  for (std::uint64_t seed = 5; seed < 10; ++seed) {
    const Scan s = scan(kEnamelPaint, kGumPaint, seed);
    ASSERT_NE(s.heaps.soft_below, kNothingSoft) << seed;
    ASSERT_GT(s.cells[0], 300U);
    ASSERT_GT(s.cells[1], 300U);
    EXPECT_LT(s.soft[0], s.cells[0] / 100) << "teeth called soft, seed " << seed;
    EXPECT_GT(s.soft[1], s.cells[1] * 99 / 100) << "gum called soft, seed " << seed;
    EXPECT_NEAR((s.heaps.hard_middle - s.heaps.soft_middle) / kShadeSteps, std::log2(0.60 / 0.22), 0.15) << seed;
  }
}

TEST(Shade, one_heap_has_no_limit) {
  for (std::uint64_t seed = 5; seed < 8; ++seed) {
    EXPECT_EQ(scan(kEnamelPaint, kEnamelPaint, seed).heaps.soft_below, kNothingSoft) << "teeth alone, seed " << seed;
    EXPECT_EQ(scan(kGumPaint, kGumPaint, seed).heaps.soft_below, kNothingSoft) << "gum alone, seed " << seed;
    EXPECT_EQ(scan(kEnamelPaint, kDentinePaint, seed).heaps.soft_below, kNothingSoft) << "dentine, seed " << seed;
  }
}

TEST(Shade, plaster_and_metal_have_none) {
  for (std::uint64_t seed = 5; seed < 7; ++seed) {
    const Scan plaster = scan(kPlaster, {0.25, 1.0}, seed);  // painted as dark as gum
    EXPECT_EQ(plaster.limit.cells(), 0U) << seed;
    EXPECT_EQ(plaster.heaps.soft_below, kNothingSoft) << seed;
    const Scan metal = scan(kEnamelPaint, kMetalPaint, seed);
    EXPECT_EQ(metal.cells[1], 0U) << "a dark crown is not gum, seed " << seed;
  }
}

TEST(Shade, steps_are_sixteenths_of_octaves) {
  EXPECT_EQ(pipeline::shade_step(0), kNoShade);
  EXPECT_EQ(pipeline::shade_step(std::nanf("")), kNoShade);
  EXPECT_EQ(pipeline::shade_step(1e-30F), 1);
  EXPECT_EQ(pipeline::shade_step(1e30F), 255);
  synthetic::Random random(3);
  for (int n = 0; n < 1000; ++n) {
    const double brightness = std::exp2(12 * random.uniform());
    const double steps = kShadeSteps * (std::log2(brightness) + 2) + 1;
    EXPECT_NEAR(pipeline::shade_step(static_cast<float>(brightness)), steps - 0.5, 0.5001) << brightness;
  }
}

TEST(Shade, patches_without_light_or_of_another_size_have_none) {
  SurfacePatch patch = render(synthetic::small_rig(), synthetic::sphere({0, 0, 6}, 6),
                              synthetic::looking_at(Vec3d::Zero(), Vec3d::UnitZ(), 48));
  patch.texture_dn = {};
  EXPECT_TRUE(shade_of(patch, light_of({})).empty());
  paint(patch, Pose::Identity(), [](const Vec3d&) { return kGumPaint; }, {});
  pipeline::ShadeLight dark = light_of({});
  dark.exposure_ms = 0;
  EXPECT_TRUE(shade_of(patch, dark).empty());
  EXPECT_FALSE(shade_of(patch, light_of({})).empty());
}

}  // namespace
}  // namespace enamel::tissue_test
