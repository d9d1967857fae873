// ICP against exact views of an analytic surface: accuracy, basin, noise law, weak directions, refusal.
#include "pipeline/register/icp/icp.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "pipeline/register/icp/patch_view.hpp"
#include "tests/unit/register/synthetic_surface.hpp"

namespace enamel::pipeline {
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

TEST(NormalSystem, motion_between_inverts_apply_motion) {
  const Pose a = ts::looking_down(3, -2, {0.2, 0.1, -0.3});
  Vector6 x;
  x << 0.1, -0.2, 0.05, 0.3, 0.2, -0.4;
  const Vec3d centre(1, 2, 3);
  const Vector6 back = motion_between(a, apply_motion(x, centre, 4.5, a), centre, 4.5);
  EXPECT_LT((back - x).norm(), 1e-12);
}

TEST(NormalSystem, prior_takes_only_the_direction_that_points_leave_free) {
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

double error_um(const IcpResult& r, const Pose& truth) { return 1e3 * ts::point_error_mm(r.T_model_cam, truth); }

TEST(Icp, recovers_known_motions_from_noiseless_patches) {
  const Scene& s = scene();
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const Pose truth = displaced(s.view.T_model_cam, seed, 0.3, 0.02);
    const IcpResult r = align_to(s, ts::make_patch(s.surface, s.lens, truth, {0, 0.0, seed}), s.view.T_model_cam);
    ASSERT_TRUE(r.converged);
    EXPECT_LT(error_um(r, truth), 2.0);
    EXPECT_LT(ts::angle_error_rad(r.T_model_cam, truth), 1e-4);
    EXPECT_EQ(r.weak_directions, 0);
    EXPECT_GT(r.overlap, 0.9);
    EXPECT_GT(r.consistency, 0.99);
  }
}

TEST(Icp, converges_from_half_a_millimetre_and_three_degrees) {
  const Scene& s = scene();
  const Pose truth = displaced(s.view.T_model_cam, 50, 0.1, 0.01);
  const SurfacePatch patch = ts::make_patch(s.surface, s.lens, truth, {0.01, 0.03, 3});
  int converged = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const IcpResult r = align_to(s, patch, displaced(truth, 1000 + seed, 0.5, 0.052));
    converged += r.converged && error_um(r, truth) < 5;
  }
  EXPECT_GE(converged, 57);
}

TEST(Icp, error_grows_with_noise_and_no_faster) {
  const Scene& s = scene();
  std::array<double, 2> rms_um{};
  const std::array<double, 2> sigma{0.02, 0.08};
  for (std::size_t level = 0; level < 2; ++level) {
    double sum = 0;
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
      const Pose truth = displaced(s.view.T_model_cam, seed, 0.05, 0.002);
      const IcpResult clean = align_to(s, ts::make_patch(s.surface, s.lens, truth, {0, 0, seed}), truth);
      const IcpResult noisy = align_to(s, ts::make_patch(s.surface, s.lens, truth, {sigma[level], 0, seed}), truth);
      const double e = 1e3 * ts::point_error_mm(clean.T_model_cam, noisy.T_model_cam);
      sum += e * e;
    }
    rms_um[level] = std::sqrt(sum / 8);
  }
  // 19 000 samples of 20 µm: a fraction of a micrometre; four times the noise, about four times the error.
  EXPECT_LT(rms_um[0], 1.0);
  EXPECT_GT(rms_um[1] / rms_um[0], 2.0);
  EXPECT_LT(rms_um[1] / rms_um[0], 8.0);
}

TEST(Icp, on_a_plane_the_prior_holds_what_the_plane_leaves_free) {
  const calib::LensValues lens = ts::test_rig().camera;
  const IcpConfig config;
  const ts::SyntheticSurface plane(5, 0.0);
  const Reference reference(ts::make_view(plane, lens, ts::looking_down(0, 0)), config.reference);
  const Pose truth = ts::looking_down(0, 0, {0.01, -0.01, 0}, 0.1);
  // The prior is right along the plane and about its normal, wrong in what the plane does show.
  const Pose prior = ts::looking_down(0.2, 0.1, {0, 0, 0.01}, 0);
  const SurfacePatch patch = ts::make_patch(plane, lens, truth, {0.01, 0.03, 9});
  const IcpResult r = align(make_pyramid(patch, config), reference, ViewCamera(lens), prior, prior, config);
  ASSERT_TRUE(r.converged);
  EXPECT_EQ(r.weak_directions, 3);
  const Vec3d at = r.T_model_cam * Vec3d(0, 0, 48);
  EXPECT_NEAR(at.x(), 0.2, 0.01);
  EXPECT_NEAR(at.y(), 0.1, 0.01);
  EXPECT_NEAR(at.z(), (truth * Vec3d(0, 0, 48)).z(), 0.001);
  const Vec3d axis = r.T_model_cam.linear().col(2);
  EXPECT_LT((axis - truth.linear().col(2)).norm(), 2e-4);
}

TEST(Icp, without_prior_stiffness_the_plane_slides) {
  const calib::LensValues lens = ts::test_rig().camera;
  IcpConfig config;
  config.prior.stiffness = 0;
  const ts::SyntheticSurface plane(5, 0.0);
  ModelView view = ts::make_view(plane, lens, ts::looking_down(0, 0));
  for (std::size_t i = 0; i < view.normals.size(); ++i) {  // a measured view's normals are never exact
    view.normals[i] +=
        0.05F * Vec3f(static_cast<float>(ts::normal(4 * i)), static_cast<float>(ts::normal(4 * i + 1)), 0);
    view.normals[i].normalize();
  }
  const Pose start = ts::looking_down(0, 0);
  const auto slide = [&](const IcpConfig& c) {
    const SurfacePatch patch = ts::make_patch(plane, lens, start, {0.03, 0.03, 9});
    const IcpResult r = align(make_pyramid(patch, c), Reference(view, c.reference), ViewCamera(lens), start, start, c);
    return (r.T_model_cam * Vec3d(0, 0, 48)).head<2>().norm();
  };
  EXPECT_GT(slide(config), 4 * slide(IcpConfig{}));
}

TEST(Icp, another_surface_contradicts) {
  const Scene& s = scene();
  for (std::uint64_t seed = 100; seed < 106; ++seed) {
    const ts::SyntheticSurface other(seed);
    const IcpResult r =
        align_to(s, ts::make_patch(other, s.lens, s.view.T_model_cam, {0.01, 0.03, seed}), s.view.T_model_cam);
    EXPECT_TRUE(!r.converged || r.consistency < 0.6) << r.consistency << ' ' << r.rms_mm;
  }
}

/// Two fifths of the patch lie `behind_mm` farther from the camera than the reference shows.
SurfacePatch with_a_part_behind(SurfacePatch patch, float behind_mm) {
  for (int v = 0; v < patch.points.height(); ++v) {
    for (int u = 0; u < patch.points.width() * 2 / 5; ++u) {
      Vec3f& p = patch.points(u, v);
      p *= (p.z() + behind_mm) / p.z();
      patch.depth_mm(u, v) += behind_mm;
    }
  }
  return patch;
}

TEST(Icp, what_the_reference_hides_does_not_contradict_it_and_what_stands_before_it_does) {
  const Scene& s = scene();
  const SurfacePatch patch = ts::make_patch(s.surface, s.lens, s.view.T_model_cam, {0.01, 0.03, 5});
  const auto consistency = [&](float behind_mm, double hidden_mm) {
    Scene other = s;
    other.config.hidden_mm = hidden_mm;
    return align_to(other, with_a_part_behind(patch, behind_mm), s.view.T_model_cam).consistency;
  };
  EXPECT_GT(consistency(1.5F, IcpConfig{}.hidden_mm), 0.95);
  EXPECT_LT(consistency(1.5F, 100), 0.7);                     // taken for contradictions
  EXPECT_LT(consistency(-1.5F, IcpConfig{}.hidden_mm), 0.7);  // nothing was there a moment ago
}

TEST(Icp, same_arguments_same_bits) {
  const Scene& s = scene();
  const Pose truth = displaced(s.view.T_model_cam, 3, 0.2, 0.01);
  const SurfacePatch patch = ts::make_patch(s.surface, s.lens, truth, {0.01, 0.03, 3});
  const IcpResult a = align_to(s, patch, s.view.T_model_cam);
  const IcpResult b = align_to(s, patch, s.view.T_model_cam);
  EXPECT_EQ(a.T_model_cam.matrix(), b.T_model_cam.matrix());
  EXPECT_EQ(a.rms_mm, b.rms_mm);
}

TEST(Samples, keep_away_from_silhouettes_and_steep_surface) {
  const Scene& s = scene();
  SurfacePatch patch = ts::make_patch(s.surface, s.lens, s.view.T_model_cam, {0, 0, 1});
  const SampleConfig config;
  const std::size_t before = sample_patch(patch, 1, config).size();
  const int u = 100;
  for (int v = 0; v < patch.depth_mm.height(); ++v) patch.depth_mm(u, v) += 1.0F;  // a wall one pixel wide
  const SampleSet after = sample_patch(patch, 1, config);
  // The column itself and two columns on either side, all but the frame of two rows.
  EXPECT_NEAR(static_cast<double>(before - after.size()), 3.0 * (patch.depth_mm.height() - 4), 60);
  EXPECT_GT(before, after.size());
}

TEST(Reference, patch_as_view_is_the_view_from_that_pose) {
  const Scene& s = scene();
  const SurfacePatch patch = ts::make_patch(s.surface, s.lens, s.view.T_model_cam, {0, 0, 1});
  const ModelView view = view_from_patch(patch, s.view.T_model_cam, s.lens, 2);
  ASSERT_FALSE(view.empty);
  std::size_t compared = 0;
  for (int j = 4; j < view.points.height() - 4; ++j) {
    for (int i = 4; i < view.points.width() - 4; ++i) {
      const Vec3f& a = view.points(i, j);
      const Vec3f& b = s.view.points(i * view.stride, j * view.stride);
      if (!std::isfinite(a.x()) || !std::isfinite(b.x())) continue;
      ++compared;
      // Rounded to the nearest camera pixel of 56 µm.
      EXPECT_LT((a - b).head<2>().norm(), 0.08F) << i << ' ' << j;
    }
  }
  EXPECT_GT(compared, view.points.size() / 2);
}

TEST(Reference, an_empty_view_aligns_nothing) {
  const Scene& s = scene();
  const Reference none(ModelView{}, s.config.reference);
  EXPECT_TRUE(none.empty());
  const SurfacePatch patch = ts::make_patch(s.surface, s.lens, s.view.T_model_cam, {0, 0, 1});
  const Pose start = ts::looking_down(1, 2);
  const IcpResult r = align(make_pyramid(patch, s.config), none, s.camera, start, start, s.config);
  EXPECT_FALSE(r.converged);
  EXPECT_EQ(r.T_model_cam.matrix(), start.matrix());
}

}  // namespace
}  // namespace enamel::pipeline
