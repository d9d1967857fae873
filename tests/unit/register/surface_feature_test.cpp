// Surface features: the same from every side, and places by their votes.
#include <gtest/gtest.h>

#include <vector>

#include "pipeline/register/feature/surface_features.hpp"
#include "pipeline/register/feature/surface_votes.hpp"
#include "tests/unit/register/turned_patches.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;

struct Seen {
  Pose T_surface_cam;
  std::vector<SurfaceFeature> features;
};

Seen look(std::uint64_t seed, const Pose& T, double relief = 1) {
  const calib::Rig rig = ts::test_rig(2);
  const SurfacePatch patch = ts::make_patch(ts::SyntheticSurface(seed, relief), rig.camera, T, {0.01, 0.03, seed});
  return {T, extract_surface_features(patch, rig.camera.fx / 48, {})};
}

std::vector<PlaceHypothesis> places(const Seen& lost, const Seen& known) {
  const std::vector<KnownFeatures> frames{{known.features, known.T_surface_cam}};
  return vote_for_places(lost.features, frames, {});
}

TEST(SurfaceGrid, areas_add_up_to_the_surface_from_every_side) {
  const calib::Rig rig = ts::test_rig(2);
  const ts::SyntheticSurface plane(3, 0);
  for (const double tilt : {0.0, 30.0, 60.0}) {
    const SurfacePatch patch = ts::make_patch(plane, rig.camera, ts::looking_from(0, 0, tilt, 20, 0), {0, 0, 1});
    const SurfaceGrid grid = make_surface_grid(patch, rig.camera.fx / 48, {});
    double area = 0;  // within 3 mm of the place looked at: on every picture
    for (std::size_t i = 0; i < grid.points.size(); ++i) {
      const Vec3d p = ts::looking_from(0, 0, tilt, 20, 0) * grid.points[i].cast<double>();
      if (p.norm() < 3) area += static_cast<double>(grid.area_mm2[i]);
    }
    // Scaled by the patch's mean depth, which a tilted field moves.
    EXPECT_NEAR(area / (9 * std::numbers::pi), 1, 0.06) << tilt;
  }
}

TEST(SurfaceFeatures, a_plane_has_none) { EXPECT_TRUE(look(5, ts::looking_down(0, 0), 0).features.empty()); }

TEST(SurfaceFeatures, frames_are_right_handed_and_descriptors_of_one_length) {
  const Seen seen = look(6, ts::looking_down(0, 0));
  ASSERT_GT(seen.features.size(), 30U);
  for (const SurfaceFeature& f : seen.features) {
    EXPECT_NEAR(f.axes.determinant(), 1, 1e-5);
    double sum = 0;
    for (const std::uint8_t x : f.descriptor) sum += static_cast<double>(x) * x;
    EXPECT_NEAR(std::sqrt(sum), 508, 10);
  }
}

TEST(SurfaceVotes, one_look_is_placed_in_another_from_any_side_and_roll) {
  int found = 0;
  int asked = 0;
  for (const double tilt : {0.0, 25.0, 40.0}) {
    for (const double roll : {0.0, 75.0, 180.0}) {
      const auto seed = static_cast<std::uint64_t>(10 + tilt);
      const Seen known = look(seed, ts::looking_down(0, 0));
      const Seen lost = look(seed, ts::looking_from(1, -0.5, tilt, 4 * roll, roll));
      const auto hypotheses = places(lost, known);
      ++asked;
      if (hypotheses.empty()) continue;
      const Pose& T = hypotheses.front().T_model_cam;
      if (ts::point_error_mm(T, lost.T_surface_cam) < 0.4 && ts::angle_error_rad(T, lost.T_surface_cam) < 0.1) ++found;
    }
  }
  EXPECT_GE(found, asked - 1);
}

TEST(SurfaceVotes, another_surface_finds_no_support_like_the_right_one) {
  const Seen known = look(30, ts::looking_down(0, 0));
  const auto right = places(look(30, ts::looking_from(1, 0, 30, 60, 90)), known);
  const auto foreign = places(look(31, ts::looking_from(1, 0, 30, 60, 90)), known);
  ASSERT_FALSE(right.empty());
  EXPECT_GT(right.front().support, 2 * (foreign.empty() ? 0 : foreign.front().support));
}

TEST(SurfaceVotes, nothing_known_or_nothing_seen_gives_no_place) {
  const Seen seen = look(40, ts::looking_down(0, 0));
  const Seen nothing{Pose::Identity(), {}};
  EXPECT_TRUE(places(nothing, seen).empty());
  EXPECT_TRUE(places(seen, nothing).empty());
}

}  // namespace
}  // namespace enamel::pipeline
