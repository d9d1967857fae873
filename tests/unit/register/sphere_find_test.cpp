// Balls of a known diameter in a burst's surface, and what must not pass for one.
#include "pipeline/register/map/sphere_find.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>

#include "tests/unit/register/synthetic_surface.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;

constexpr double kNoiseMm = 0.012;

/// Depth of a surface along a ray, mm; and its outer normal.
struct Met {
  double depth;
  Vec3d normal;
};
using Scene = std::function<std::optional<Met>(const Vec3d& ray)>;

/// A plane 52 mm before the camera.
std::optional<Met> plane(const Vec3d&) { return Met{52, -Vec3d::UnitZ()}; }

Scene ball(const Vec3d& centre, double radius) {
  return [=](const Vec3d& ray) -> std::optional<Met> {
    const double aa = ray.squaredNorm(), ab = ray.dot(centre);
    const double root2 = ab * ab - aa * (centre.squaredNorm() - radius * radius);
    if (root2 <= 0) return plane(ray);
    const double depth = (ab - std::sqrt(root2)) / aa;
    return Met{depth, (depth * ray - centre) / radius};
  };
}

/// A cusp: as round at its tip as a ball, a paraboloid or a cone farther out.
Scene cusp(const Vec3d& tip, double radius, bool is_cone) {
  return [=](const Vec3d& ray) -> std::optional<Met> {
    double depth = tip.z();
    double slope = 0;
    Vec3d across = Vec3d::Zero();
    for (int k = 0; k < 60; ++k) {  // by fixed point, half steps
      across = Vec3d(ray.x() * depth - tip.x(), ray.y() * depth - tip.y(), 0);
      const double r = across.norm();
      const double fall = is_cone ? std::hypot(r, radius) - radius : r * r / (2 * radius);
      slope = is_cone ? r / std::hypot(r, radius) : r / radius;
      depth += 0.5 * (tip.z() + fall - depth);
    }
    if (depth >= 52) return plane(ray);
    const Vec3d out = across.norm() > 0 ? Vec3d(across.normalized()) : Vec3d(Vec3d::Zero());
    return Met{depth, (slope * out - Vec3d::UnitZ()).normalized()};
  };
}

SurfacePatch picture(const Scene& scene, std::uint64_t seed, double sigma = kNoiseMm) {
  const calib::LensValues camera = ts::test_rig(1).camera;
  const Vec3f none = Vec3f::Constant(std::nanf(""));
  SurfacePatch out;
  out.depth_mm = Map<float>(camera.width, camera.height, std::nanf(""));
  out.sigma_mm = out.depth_mm;
  out.points = Map<Vec3f>(camera.width, camera.height, none);
  out.normals = out.points;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Vec3d ray = ts::pixel_ray(camera, u, v);
      const auto met = scene(ray);
      const std::size_t i = out.depth_mm.index(u, v);
      const std::uint64_t key = ts::mix(seed) + 8 * i;
      if (!met || -met->normal.dot(ray.normalized()) < 0.3) continue;
      const double z = met->depth + sigma * ts::normal(key);
      const Vec3d n = met->normal + 0.03 * Vec3d(ts::normal(key + 1), ts::normal(key + 2), ts::normal(key + 3));
      out.depth_mm[i] = static_cast<float>(z);
      out.sigma_mm[i] = static_cast<float>(sigma);
      out.points[i] = (z * ray).cast<float>();
      out.normals[i] = n.normalized().cast<float>();
    }
  }
  return out;
}

std::vector<FoundSphere> find(const SurfacePatch& patch, double radius) {
  return find_spheres(patch, ts::test_rig(1).camera, radius, {});
}

TEST(SphereFind, a_ball_is_found_wherever_it_lies_and_as_surely_as_it_says) {
  double chi2 = 0;
  constexpr int kDraws = 12;
  for (std::uint64_t n = 0; n < kDraws; ++n) {
    const Vec3d centre(8 * ts::uniform(7 * n) - 4, 6 * ts::uniform(7 * n + 1) - 3, 45 + 5 * ts::uniform(7 * n + 2));
    const auto found = find(picture(ball(centre, 1.5), n), 1.5);
    ASSERT_EQ(found.size(), 1U) << n;
    const Vec3d off = found[0].centre - centre;
    EXPECT_LT(off.norm(), 0.003);
    EXPECT_LT(std::sqrt(found[0].covariance.trace()), 0.003);
    chi2 += off.dot(found[0].covariance.inverse() * off) / 3 / kDraws;
  }
  EXPECT_GT(chi2, 0.3);
  EXPECT_LT(chi2, 2.5);
}

TEST(SphereFind, a_wider_ball_moves_the_centre_as_foretold) {
  const Vec3d centre(1, -1, 48);
  const SurfacePatch patch = picture(ball(centre, 1.5), 5, 1e-4);
  const auto as_is = find(patch, 1.5), wider = find(patch, 1.504);
  ASSERT_EQ(as_is.size() + wider.size(), 2U);
  EXPECT_LT((wider[0].centre - 0.004 * wider[0].per_radius - centre).norm(), 2e-4);
  EXPECT_GT((wider[0].centre - centre).norm(), 0.002) << "negative control: uncorrected";
  EXPECT_NEAR(wider[0].radius_off_mm, -0.004, 5e-4);
}

TEST(SphereFind, a_ball_of_another_diameter_is_not_taken) {
  for (const double radius : {1.3, 1.44, 1.56, 1.75, 2.0})
    EXPECT_TRUE(find(picture(ball({0.5, 1, 47}, radius), 3), 1.5).empty()) << radius;
}

TEST(SphereFind, cusps_planes_and_teeth_are_no_balls) {
  EXPECT_TRUE(find(picture(plane, 1), 1.5).empty());
  for (const bool is_cone : {false, true}) {
    for (const double radius : {0.8, 1.2, 1.5, 1.8})
      EXPECT_TRUE(find(picture(cusp({0.5, -1, 46}, radius, is_cone), 2), 1.5).empty()) << is_cone << radius;
  }
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const auto patch = ts::make_patch(ts::SyntheticSurface(seed), ts::test_rig(1).camera, ts::looking_down(3, 2),
                                      {kNoiseMm, 0.03, seed});
    for (const double radius : {0.75, 1.0, 1.5, 2.0})
      EXPECT_TRUE(find_spheres(patch, ts::test_rig(1).camera, radius, {}).empty()) << seed << " " << radius;
  }
}

TEST(SphereFind, half_a_ball_behind_something_else_is_not_taken) {
  const Scene whole = ball({0, 0, 47}, 1.5);
  const Scene hidden = [&](const Vec3d& ray) { return ray.x() > 0 ? Met{44, -Vec3d::UnitZ()} : whole(ray); };
  EXPECT_EQ(find(picture(whole, 4), 1.5).size(), 1U) << "negative control";
  EXPECT_TRUE(find(picture(hidden, 4), 1.5).empty());
}

}  // namespace
}  // namespace enamel::pipeline
