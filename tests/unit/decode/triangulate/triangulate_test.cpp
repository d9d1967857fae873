#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pipeline/decode/triangulate/normals.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

/// Largest distance of the baked form from the iterative one over the field and the depth, um.
double worst_distance_um(const calib::Rig& rig) {
  const RayDepth rays = RayDepth::bake(rig, *rig.depth_range).value();
  double worst_um = 0;
  for (int v = 0; v < 480; v += 31) {
    for (int u = 0; u < 640; u += 37) {
      const std::size_t i = static_cast<std::size_t>(v) * 640 + static_cast<std::size_t>(u);
      const calib::PlanePoint ray = calib::undistort(rig.camera, {static_cast<double>(u), static_cast<double>(v)});
      for (int s = 0; s <= 20; ++s) {
        const double share = s / 20.0;
        const auto phase = static_cast<float>(rays.phase_near_rad[i] * (1 - share) + rays.phase_far_rad[i] * share);
        const auto exact = depth_by_iteration(rig, ray, static_cast<double>(phase), 48);
        worst_um =
            std::max(worst_um, 1e3 * std::abs(1 / static_cast<double>(rays.inverse_depth(i, phase)) - exact.value()));
      }
    }
  }
  return worst_um;
}

/// A field of that many micrometres at 48 mm in every one of its terms.
calib::CorrectionField field_of(double um) {
  calib::CorrectionField f{
      .u_px = {0, 639}, .v_px = {0, 479}, .inverse_mm = {1.0 / 56, 1.0 / 40}, .terms = {3, 3, 3}, .coefficients = {}};
  f.coefficients.assign(27, um * 1e-3 / (48.0 * 48.0));
  return f;
}

TEST(RayDepth, baked_cubic_meets_the_iterative_form_within_a_tenth_of_a_micrometre) {
  calib::Rig rig = calib::parse_rig(test::kRigText).value();  // whole field: the corners are the hard part
  EXPECT_LE(worst_distance_um(rig), 0.1);
  rig.correction = field_of(2);
  EXPECT_LE(worst_distance_um(rig), 0.1);
}

TEST(RayDepth, correction_moves_depth_by_what_it_says) {
  calib::Rig rig = calib::parse_rig(test::kRigText).value();
  const RayDepth plain = RayDepth::bake(rig, *rig.depth_range).value();
  rig.correction = field_of(2);
  const RayDepth moved = RayDepth::bake(rig, *rig.depth_range).value();
  for (const std::size_t i : {0U, 640U * 400 + 500U, 640U * 480 - 1}) {
    const float phase = 0.9F * plain.phase_near_rad[i] + 0.1F * plain.phase_far_rad[i];
    const double q = static_cast<double>(plain.inverse_depth(i, phase));
    const std::size_t u = i % 640, v = i / 640;
    const double delta = calib::correction_at(*rig.correction, static_cast<double>(u), static_cast<double>(v), q);
    ASSERT_GT(std::abs(delta), 1e-8);
    // A float of 1/48 resolves 2e-9.
    EXPECT_NEAR(static_cast<double>(moved.inverse_depth(i, phase)) - q, delta, 1e-8);
  }
}

TEST(RayDepth, correction_of_zeros_changes_no_bit) {
  calib::Rig rig = test::cropped_rig(64, 64);
  const RayDepth plain = RayDepth::bake(rig, *rig.depth_range).value();
  rig.correction = field_of(0);
  const RayDepth zero = RayDepth::bake(rig, *rig.depth_range).value();
  EXPECT_EQ(plain.c0, zero.c0);
  EXPECT_EQ(plain.c3, zero.c3);
}

TEST(RayDepth, iteration_inverts_the_projection) {
  const calib::Rig rig = test::cropped_rig(64, 64);
  for (const double z : {40.0, 44.5, 48.0, 53.0, 56.0}) {
    const calib::PlanePoint ray = calib::undistort(rig.camera, {12, 50});
    const double phase = 2 * std::numbers::pi * calib::project_to_projector(rig, ray, z).x / rig.patterns.period_px;
    EXPECT_NEAR(depth_by_iteration(rig, ray, phase, 48).value(), z, 1e-9);
  }
}

TEST(RayDepth, geometry_that_cannot_measure_depth_is_refused) {
  calib::Rig rig = test::cropped_rig(16, 16);
  rig.T_proj_cam = {{{1, 0, 0, 0}, {0, 1, 0, -10}, {0, 0, 1, 0}, {0, 0, 0, 1}}};  // baseline along the fringes
  const auto rays = RayDepth::bake(rig, *rig.depth_range);
  ASSERT_FALSE(rays);
  EXPECT_EQ(rays.error().code, ErrorCode::kRigInvalid);
}

TEST(RayDepth, the_sparse_table_holds_every_second_pixel_of_every_second_row) {
  const calib::Rig rig = test::cropped_rig(21, 11);
  const RayDepth rays = RayDepth::bake(rig, *rig.depth_range).value();
  ASSERT_EQ(rays.sparse.c0.size(), 11U * 6U);
  for (std::size_t y = 0; y < 6; ++y) {
    for (std::size_t x = 0; x < 11; ++x) {
      const std::size_t k = y * 11 + x, i = 2 * y * 21 + 2 * x;
      EXPECT_EQ(rays.sparse.phase_mid_rad[k], rays.phase_mid_rad[i]);
      EXPECT_EQ(rays.sparse.c0[k], rays.c0[i]);
      EXPECT_EQ(rays.sparse.c1[k], rays.c1[i]);
      EXPECT_EQ(rays.sparse.c2[k], rays.c2[i]);
      EXPECT_EQ(rays.sparse.c3[k], rays.c3[i]);
    }
  }
}

struct NormalScene {
  RayDepth rays;
  Map<float> inverse, sigma;
  Map<Vec3f> normals;
  std::vector<float> scratch;

  explicit NormalScene(const std::function<double(int, int)>& depth) {
    const calib::Rig rig = test::cropped_rig(80, 60);
    rays = RayDepth::bake(rig, *rig.depth_range).value();
    inverse = Map<float>(80, 60);
    sigma = Map<float>(80, 60, 0.008F);
    for (int v = 0; v < 60; ++v)
      for (int u = 0; u < 80; ++u) inverse(u, v) = static_cast<float>(1 / depth(u, v));
    compute_normals(rays, inverse, sigma, {}, scratch, normals);
  }
};

TEST(Normals, of_a_tilted_plane_are_exact_and_face_the_camera) {
  const Eigen::Vector3d n = Eigen::Vector3d(0.5, -0.3, -1).normalized();
  const calib::Rig rig = test::cropped_rig(80, 60);
  const NormalScene s([&](int u, int v) {
    const auto ray = calib::undistort(rig.camera, {static_cast<double>(u), static_cast<double>(v)});
    return n.z() * 48 / (n.x() * ray.x + n.y() * ray.y + n.z());
  });
  for (int v = 3; v < 57; ++v) {
    for (int u = 3; u < 77; ++u) {
      const double c = s.normals(u, v).cast<double>().dot(n);
      ASSERT_LT(std::acos(std::min(1.0, c)) * 180 / std::numbers::pi, 0.3) << u << "," << v;
    }
  }
}

TEST(Normals, do_not_mix_two_surfaces_across_a_step) {
  const NormalScene s([](int u, int) { return u < 40 ? 46.0 : 50.0; });
  for (int v = 3; v < 57; ++v)
    for (const int u : {36, 37, 38, 41, 42, 43}) ASSERT_LT(s.normals(u, v).z(), -0.999F) << u << "," << v;
}

TEST(Normals, are_nan_where_there_is_no_depth) {
  const NormalScene s([](int u, int) { return u == 40 ? std::nan("") : 48.0; });
  EXPECT_TRUE(std::isnan(s.normals(40, 30).z()));
  EXPECT_FALSE(std::isnan(s.normals(42, 30).z()));
}

}  // namespace
}  // namespace enamel::pipeline
