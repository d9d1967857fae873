// ICP against exact views of an analytic surface: accuracy, basin, noise law, weak directions, refusal.
#include "pipeline/algo/icp/icp.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "tests/unit/registration/synthetic_surface.hpp"

namespace enamel::algo {
namespace {

namespace ts = ::enamel::testing;

struct Scene {
  calib::LensValues lens = ts::test_rig().camera;
  ViewCamera camera{lens};
  IcpConfig config;
  ts::SyntheticSurface surface{7};
  ModelView view = ts::make_view(surface, lens, ts::looking_down(0, 0));
  Reference reference{view, config.reference};
};

const Scene& scene() {
  static const Scene instance;
  return instance;
}

IcpResult align_to(const Scene& s, const SurfacePatch& patch, const Pose& start) {
  return align(make_pyramid(patch, s.config), s.reference, s.camera, start, start, s.config);
}

Pose displaced(const Pose& T, std::uint64_t seed, double shift_mm, double turn_rad) {
  const Vec3d t(ts::normal(seed * 10), ts::normal(seed * 10 + 1), ts::normal(seed * 10 + 2));
  const Vec3d r(ts::normal(seed * 10 + 3), ts::normal(seed * 10 + 4), ts::normal(seed * 10 + 5));
  Vector6 x;
  x << r.normalized() * turn_rad, t.normalized() * shift_mm;
  return apply_motion(x, T * Vec3d(0, 0, 48), 1.0, T);
}

TEST(NormalSystem, MotionBetweenInvertsApplyMotion) {
  const Pose a = ts::looking_down(3, -2, {0.2, 0.1, -0.3});
  Vector6 x;
  x << 0.1, -0.2, 0.05, 0.3, 0.2, -0.4;
  const Vec3d centre(1, 2, 3);
  const Vector6 back = motion_between(a, apply_motion(x, centre, 4.5, a), centre, 4.5);
  EXPECT_LT((back - x).norm(), 1e-12);
}

TEST(NormalSystem, PriorTakesOnlyTheDirectionThatPointsLeaveFree) {
  NormalSystem system;
  for (int i = 0; i < 6; ++i) {
    if (i == 3) continue;
    system.add(Vector6::Unit(i), -0.25, 1.0);
  }
  Vector6 prior = Vector6::Constant(9.0);
  prior[3] = 0.125;
  const Solution solution = solve(system, prior, {});
  EXPECT_EQ(solution.weak, 1);
  EXPECT_NEAR(solution.x[3], 0.125, 1e-12);
  EXPECT_NEAR(solution.x[0], 0.25, 1e-9);
}

TEST(Icp, RecoversKnownMotionsFromNoiselessPatches) {
  const Scene& s = scene();
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const Pose truth = displaced(s.view.T_model_cam, seed, 0.4, 0.02);
    const IcpResult r = align_to(s, ts::make_patch(s.surface, s.lens, truth, {0, 0.0, seed}), s.view.T_model_cam);
    ASSERT_TRUE(r.converged);
    EXPECT_LT(ts::point_error_mm(r.T_model_cam, truth), 0.002);
    EXPECT_LT(ts::angle_error_rad(r.T_model_cam, truth), 2e-4);
  }
}

}  // namespace
}  // namespace enamel::algo
