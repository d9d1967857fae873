// Soft tissue as a class of the model: by its shade, by its moving, kept in the mesh, never on plaster.
#include <gtest/gtest.h>

#include "pipeline/model/fuse/tissue_votes.hpp"
#include "pipeline/model/mesh/incremental_mesher.hpp"
#include "tests/unit/model/synthetic.hpp"

namespace enamel::pipeline {
namespace {

constexpr std::uint8_t kTooth = 150, kGum = 125, kLimit = 138;

/// What bursts see of a plane; in each it may stand somewhere else.
struct Told {
  std::uint8_t left = kTooth, right = kTooth;  ///< shades for x < 0 and beyond; both kNoShade: plaster
  double wander_mm = 0;                        ///< standard deviation of the plane's height, burst by burst
  std::uint8_t limit = kLimit;
};

Mesh scanned(const Told& told, std::uint64_t seed) {
  synthetic::Random random(seed);
  const calib::Rig rig = synthetic::small_rig();
  TsdfModel model(rig);
  model.set_soft_below(told.limit);
  for (std::uint64_t n = 0; n < 7; ++n) {
    const Pose pose = synthetic::looking_at(random.vector(), Vec3d(0, 0, 1) + 0.4 * random.vector(), 48);
    const auto surface = synthetic::plane({0, 0, -1}, told.wander_mm * random.normal());
    SurfacePatch patch = render(rig, surface, pose, {.noisy = true, .seed = 31 * seed + n});
    if (told.left != kNoShade || told.right != kNoShade) {
      patch.shade = ShadeMap(patch.points.width() / kShadeCell_px, patch.points.height() / kShadeCell_px, kNoShade);
      for (int j = 0; j < patch.shade.height(); ++j) {
        for (int i = 0; i < patch.shade.width(); ++i) {
          const Vec3f p = patch.points(i * kShadeCell_px + 4, j * kShadeCell_px + 4);
          if (!std::isfinite(p.x())) continue;
          patch.shade(i, j) = (pose * p.cast<double>()).x() < 0 ? told.left : told.right;
        }
      }
    }
    model.integrate(BurstId{n}, patch, pose);
  }
  IncrementalMesher mesher;
  mesher.update(model, model.take_changed());
  return mesher.extract();
}

double share_soft(const Mesh& mesh, double from_mm, double to_mm) {
  std::size_t soft = 0, all = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const auto x = static_cast<double>(mesh.vertices[i].x());
    if (x < from_mm || x > to_mm) continue;
    ++all;
    soft += mesh.soft.empty() ? 0U : mesh.soft[i];
  }
  return all == 0 ? -1 : static_cast<double>(soft) / static_cast<double>(all);
}

TEST(ModelTissue, gum_is_soft_up_to_the_teeth_and_stays_in_the_mesh) {
  for (std::uint64_t seed = 5; seed < 6; ++seed) {
    const Mesh mesh = scanned({.left = kGum}, seed), teeth = scanned({}, seed);
    ASSERT_EQ(mesh.soft.size(), mesh.vertices.size());
    // The limit lies within half a block of the border: 0.4 mm.
    EXPECT_GT(share_soft(mesh, -4, -0.4), 0.99) << seed;
    EXPECT_LT(share_soft(mesh, 0.4, 4), 0.01) << seed;
    EXPECT_EQ(mesh.triangles.size(), teeth.triangles.size()) << "nothing is left out";
    EXPECT_TRUE(teeth.soft.empty());
  }
}

TEST(ModelTissue, what_moves_is_soft_however_bright) {
  for (std::uint64_t seed = 5; seed < 6; ++seed) {
    EXPECT_GT(share_soft(scanned({.wander_mm = 0.25}, seed), -4, 4), 0.5) << seed;
    EXPECT_LT(share_soft(scanned({.wander_mm = 0.02}, seed), -4, 4), 0.01) << "as poses err, seed " << seed;
  }
}

TEST(ModelTissue, plaster_never_is) {
  for (std::uint64_t seed = 5; seed < 6; ++seed) {
    EXPECT_TRUE(scanned({.left = kNoShade, .right = kNoShade}, seed).soft.empty()) << seed;
    EXPECT_TRUE(scanned({.left = kNoShade, .right = kNoShade, .wander_mm = 0.25}, seed).soft.empty()) << seed;
    EXPECT_TRUE(scanned({.left = kGum, .limit = kNothingSoft}, seed).soft.empty()) << "no limit is known";
  }
}

TEST(ModelTissue, another_limit_meshes_all_blocks_anew) {
  const calib::Rig rig = synthetic::small_rig();
  TsdfModel model(rig);
  IncrementalMesher mesher;
  const Pose pose = synthetic::looking_at(Vec3d::Zero(), Vec3d::UnitZ(), 48);
  SurfacePatch patch = render(rig, synthetic::plane({0, 0, -1}, 0.0), pose);
  patch.shade = ShadeMap(patch.points.width() / kShadeCell_px, patch.points.height() / kShadeCell_px, kGum);
  for (std::uint64_t n = 0; n < 3; ++n) model.integrate(BurstId{n}, patch, pose);
  mesher.update(model, model.take_changed());
  EXPECT_TRUE(mesher.extract().soft.empty());
  EXPECT_EQ(mesher.update(model, {}).blocks_meshed, 0U) << "control";
  model.set_soft_below(kLimit);
  EXPECT_GT(mesher.update(model, {}).blocks_meshed, 0U);
  EXPECT_GT(share_soft(mesher.extract(), -4, 4), 0.99);
}

}  // namespace
}  // namespace enamel::pipeline
