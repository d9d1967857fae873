// Compare against analytic offsets and known motions.
#include "host/compare/compare.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "host/compare/deviation_picture.hpp"
#include "tests/unit/host/mesh_shapes.hpp"
#include "tests/unit/model/synthetic.hpp"

namespace enamel::host {
namespace {

CompareResult compared(const Mesh& mesh, const std::vector<MeshFile>& references, const CompareInput& input = {}) {
  auto result = compare(mesh, references, input);
  EXPECT_TRUE(result.has_value());
  return result ? *result : CompareResult{};
}

double area(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3f a = mesh.vertices[t[0]];
    sum += 0.5 * static_cast<double>((mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm());
  }
  return sum;
}

TEST(Compare, a_ball_ten_micrometres_too_large_deviates_by_plus_ten) {
  const CompareResult r = compared(ball(3.010).mesh, {ball(3.0)});
  EXPECT_NEAR(r.mean_abs_um, 10.0, 0.2);
  EXPECT_NEAR(r.median_um, 10.0, 0.2);
  EXPECT_NEAR(r.rms_um, 10.0, 0.2);
  EXPECT_NEAR(r.p99_um, 10.0, 0.4);
  EXPECT_NEAR(r.coverage_pct, 100.0, 1e-9);
}

TEST(Compare, one_too_small_deviates_by_minus_ten) {
  const CompareResult r = compared(ball(2.990).mesh, {ball(3.0)});
  EXPECT_NEAR(r.median_um, -10.0, 0.15);
  EXPECT_NEAR(r.mean_abs_um, 10.0, 0.15);
}

TEST(Compare, signs_hold_at_sharp_corners_of_soups_without_shared_vertices) {
  // A cube as twelve loose triangles: nearest points of these probes lie on its corners and edges.
  Mesh cube;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0F, 1.0F}) {
      const auto at = [&](float u, float v) {
        Vec3f p;
        p[axis] = side;
        p[(axis + 1) % 3] = u;
        p[(axis + 2) % 3] = v * side;
        return p;
      };
      const auto first = static_cast<std::uint32_t>(cube.vertices.size());
      for (const Vec3f& p : {at(-1, -1), at(1, -1), at(1, 1), at(-1, -1), at(1, 1), at(-1, 1)}) {
        cube.vertices.push_back(p);
      }
      cube.triangles.push_back({first, first + 1, first + 2});
      cube.triangles.push_back({first + 3, first + 4, first + 5});
    }
  }
  const SignedSurface surface(cube);
  synthetic::Random random(9);
  for (int k = 0; k < 2000; ++k) {
    const Vec3d p = 3 * random.vector();
    EXPECT_EQ(surface.distance(p).distance_mm > 0, p.cwiseAbs().maxCoeff() > 1.0) << p.transpose();
    EXPECT_FALSE(surface.distance(p).on_border);
  }
}

TEST(Compare, coverage_is_the_share_of_reference_area_and_a_hole_is_missed) {
  const MeshFile whole = relief(0.25);
  MeshFile mesh = whole;
  std::erase_if(mesh.mesh.triangles, [&](const auto& t) { return mesh.mesh.vertices[t[0]].x() > 0.0F; });
  const double expected = 100.0 * area(mesh.mesh) / area(whole.mesh);
  const double rim = 100.0 * 0.1 / 20.0;  // the reference within 0.1 mm beyond the cut is covered too
  const double covered = compared(mesh.mesh, {whole}).coverage_pct;
  EXPECT_GT(covered, expected);
  EXPECT_LT(covered, expected + 2.0 * rim);
}

TEST(Compare, only_what_the_probe_saw_counts_for_coverage) {
  MeshFile mesh = relief(0.25);
  std::erase_if(mesh.mesh.triangles, [&](const auto& t) { return mesh.mesh.vertices[t[0]].x() > 0.0F; });
  MeshFile reference = relief(0.25);
  for (const Vec3f& v : reference.mesh.vertices) {
    reference.vertex_values["seen"].push_back(v.x() < -0.2F ? 3.0F : 2.0F);
  }
  EXPECT_NEAR(compared(mesh.mesh, {reference}).coverage_pct, 100.0, 1e-9);
}

TEST(Compare, several_references_are_one_surface) {
  MeshFile left = relief(0.25);
  MeshFile right = left;
  std::erase_if(left.mesh.triangles, [&](const auto& t) { return left.mesh.vertices[t[0]].x() > 1.0F; });
  std::erase_if(right.mesh.triangles, [&](const auto& t) { return right.mesh.vertices[t[0]].x() < -1.0F; });
  const Mesh mesh = relief(0.25).mesh;
  EXPECT_LT(compared(mesh, {left, right}).max_um, 0.01);
  EXPECT_GT(compared(mesh, {left}).max_um, 5000.0);
  EXPECT_GT(compared(mesh, {left}).beyond_border_pct, 30.0);
}

TEST(Compare, what_lies_far_from_the_reference_is_foreign_by_its_area) {
  const MeshFile reference = relief(0.25);
  Mesh mesh = reference.mesh;
  EXPECT_EQ(compared(mesh, {reference}).foreign_pct, 0.0);
  double own_mm2 = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3f ab = mesh.vertices[t[1]] - mesh.vertices[t[0]], ac = mesh.vertices[t[2]] - mesh.vertices[t[0]];
    own_mm2 += 0.5 * static_cast<double>(ab.cross(ac).norm());
  }
  // Two square millimetres float far above.
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3f& corner : {Vec3f(0, 0, 5), Vec3f(2, 0, 5), Vec3f(0, 2, 5)}) mesh.vertices.push_back(corner);
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.normals.clear();
  mesh.quality.clear();
  EXPECT_NEAR(compared(mesh, {reference}).foreign_pct, 100.0 * 2.0 / (own_mm2 + 2.0), 0.01);
}

TEST(Compare, percentiles_follow_the_distribution) {
  // A tenth of the surface is raised by 80 um.
  const Mesh mesh = relief(0.25, [](double x, double) { return x > 8.0 ? 0.08 : 0.0; }).mesh;
  const CompareResult r = compared(mesh, {relief(0.25)});
  EXPECT_LT(r.median_um, 1.0);
  EXPECT_GT(r.p95_um, 40.0);
  EXPECT_LE(r.p95_um, r.p99_um);
  EXPECT_LE(r.p99_um, r.max_um);
  EXPECT_LE(r.max_um, 80.1);
}

Pose motion(double angle_rad, const Vec3d& shift) {
  Pose T = Pose::Identity();
  T.linear() = Eigen::AngleAxisd(angle_rad, Vec3d(1, -2, 3).normalized()).toRotationMatrix();
  T.translation() = shift;
  return T;
}

Mesh moved(Mesh mesh, const Pose& T) {
  for (Vec3f& v : mesh.vertices) {
    v = (T * v.cast<double>()).cast<float>();
  }
  return mesh;
}

TEST(Compare, best_finds_small_and_large_motions) {
  const MeshFile reference = relief(0.2);
  const Mesh mesh = relief(0.23).mesh;
  const double floor_um = compared(mesh, {reference}).mean_abs_um;  // other samples of the same relief
  for (const Pose& T : {motion(0.03, {0.3, -0.2, 0.4}), motion(2.0, {30, -20, 15})}) {
    const Mesh away = moved(mesh, T);
    EXPECT_GT(compared(away, {reference}).mean_abs_um, 100.0);
    const CompareResult r = compared(away, {reference}, {Alignment::kBest, nullptr, nullptr});
    EXPECT_LT(r.mean_abs_um, floor_um + 1.0);
    EXPECT_LT((r.T_reference_mesh * T).translation().norm(), 0.01);
  }
}

TEST(Compare, best_is_not_pulled_by_outliers) {
  const Mesh mesh =
      moved(relief(0.25, [](double x, double) { return x > 8.0 ? 0.8 : 0.0; }).mesh, motion(0.02, {0.1, 0.1, 0.1}));
  const CompareResult r = compared(mesh, {relief(0.2)}, {Alignment::kBest, nullptr, nullptr});
  EXPECT_LT(std::abs(r.median_um), 3.0);
}

std::vector<PoseRow> track(const Pose& before, double scale, double drift_mm) {
  std::vector<PoseRow> rows;
  for (std::uint64_t k = 0; k < 20; ++k) {
    const auto s = static_cast<double>(k);
    PoseRow row{k, 0, motion(0.01 * s, Vec3d(s, 0.1 * s * s, 0) * scale)};
    row.T_model_cam.translation() += Vec3d(0, 0, drift_mm * s / 19.0);
    row.T_model_cam = before * row.T_model_cam;
    rows.push_back(row);
  }
  return rows;
}

TEST(Compare, start_lays_the_first_poses_on_each_other_and_tells_what_is_left_at_the_end) {
  const Pose frame = motion(1.0, {5, 6, 7});
  const auto truth = track(Pose::Identity(), 1.0, 0.0);
  const auto estimate = track(frame, 1.0, 0.05);
  const Mesh mesh = moved(relief(0.25).mesh, frame);
  const CompareResult r = compared(mesh, {relief(0.25)}, {Alignment::kStart, &estimate, &truth});
  EXPECT_LT(r.mean_abs_um, 0.05);
  ASSERT_TRUE(r.end.has_value());
  EXPECT_NEAR(r.end->end_error_um, 50.0, 1e-3);
  EXPECT_NEAR(r.end->end_rotation_deg, 0.0, 1e-5);
}

TEST(Compare, an_estimate_a_thousandth_too_large_has_positive_scale) {
  const auto truth = track(Pose::Identity(), 1.0, 0.0);
  auto estimate = truth;
  for (PoseRow& row : estimate) {  // the 48-mm points, not the cameras, grow by 1e-3
    const Vec3d far(0, 0, 48);
    row.T_model_cam.translation() += 1e-3 * (row.T_model_cam * far);
  }
  const auto start = align_start(estimate, truth);
  ASSERT_TRUE(start.has_value());
  ASSERT_TRUE(start->end.scale_ppm.has_value());
  EXPECT_NEAR(*start->end.scale_ppm, 1000.0, 1.0);
}

TEST(Compare, start_needs_poses_with_a_common_burst) {
  const auto truth = track(Pose::Identity(), 1.0, 0.0);
  auto later = truth;
  for (PoseRow& row : later) {
    row.burst_id += 100;
  }
  const Mesh mesh = relief(1.0).mesh;
  const std::vector<MeshFile> reference{relief(1.0)};
  EXPECT_EQ(compare(mesh, reference, {Alignment::kStart, &truth, nullptr}).error().code, ErrorCode::kUsage);
  EXPECT_EQ(compare(mesh, reference, {Alignment::kStart, &truth, &later}).error().code, ErrorCode::kBurstNotFound);
  EXPECT_EQ(compare(Mesh{}, reference, {}).error().code, ErrorCode::kMeshInvalid);
  EXPECT_EQ(compare(mesh, {}, {}).error().code, ErrorCode::kMeshInvalid);
}

TEST(Compare, json_has_the_agreed_keys) {
  const auto j = nlohmann::json::parse(compare_json(compared(relief(1.0).mesh, {relief(1.0)})));
  for (const char* key : {"mean_abs_um", "median_um", "rms_um", "p95_um", "p99_um", "max_um", "coverage_pct",
                          "foreign_pct", "end_error_um", "end_rotation_deg", "scale_ppm", "align"}) {
    EXPECT_TRUE(j.contains(key)) << key;
  }
  EXPECT_EQ(j["align"], "none");
  EXPECT_TRUE(j["end_error_um"].is_null());
}

TEST(DeviationPicture, shows_both_signs_in_their_colours) {
  const Mesh mesh = relief(0.25, [](double x, double) { return x > 0 ? 0.08 : -0.08; }).mesh;
  const CompareResult r = compared(mesh, {relief(0.25)});
  const auto png = deviation_png(mesh, r);
  ASSERT_GT(png.size(), 1000U);
  EXPECT_EQ(png[1], 'P');
  const VertexColours colours = deviation_colours({-100.0F, 0.0F, 100.0F}, 100.0);
  EXPECT_EQ(colours[0], (std::array<std::uint8_t, 3>{0, 0, 255}));
  EXPECT_EQ(colours[1], (std::array<std::uint8_t, 3>{255, 255, 255}));
  EXPECT_EQ(colours[2], (std::array<std::uint8_t, 3>{255, 0, 0}));
  EXPECT_TRUE(deviation_png(Mesh{}, r).empty());
}

}  // namespace
}  // namespace enamel::host
