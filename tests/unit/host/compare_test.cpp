// Compare against analytic offsets and known motions.
#include "host/compare/compare.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "host/compare/deviation_picture.hpp"
#include "host/compare/triangle_tree.hpp"
#include "tests/unit/model/synthetic.hpp"

namespace enamel::host {
namespace {

/// Grid over (a, b) in [0, 1]^2, triangles wound as the grid of a sphere or height field seen from outside.
MeshFile grid(int na, int nb, const std::function<Vec3d(double, double)>& at) {
  MeshFile file;
  for (int j = 0; j <= nb; ++j) {
    for (int i = 0; i <= na; ++i) {
      file.mesh.vertices.push_back(at(static_cast<double>(i) / na, static_cast<double>(j) / nb).cast<float>());
    }
  }
  for (int j = 0; j < nb; ++j) {
    for (int i = 0; i < na; ++i) {
      const auto v = static_cast<std::uint32_t>(j * (na + 1) + i);
      const auto w = v + static_cast<std::uint32_t>(na) + 1;
      file.mesh.triangles.push_back({v, v + 1, w + 1});
      file.mesh.triangles.push_back({v, w + 1, w});
    }
  }
  return file;
}

MeshFile ball(double radius, int n = 300) {
  return grid(n, n / 2, [=](double a, double b) {
    const double lon = 2 * M_PI * a;
    const double lat = M_PI * (b - 0.5);
    return Vec3d(radius * std::cos(lat) * std::cos(lon), radius * std::cos(lat) * std::sin(lon),
                 radius * std::sin(lat));
  });
}

/// 20 x 12 mm without any symmetry, outside is +z.
MeshFile relief(double step_mm, const std::function<double(double, double)>& raise = {}) {
  const int na = static_cast<int>(20.0 / step_mm);
  const int nb = static_cast<int>(12.0 / step_mm);
  return grid(na, nb, [&](double a, double b) {
    const double x = 20 * a - 10;
    const double y = 12 * b - 6;
    const double z =
        1.5 * std::sin(0.7 * x + 0.2) * std::cos(0.9 * y) + 0.05 * x * y + 0.3 * std::sin(2.1 * x) + 0.02 * x * x;
    return Vec3d(x, y, z + (raise ? raise(x, y) : 0.0));
  });
}

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

TEST(TriangleTree, FindsWhatAFullSearchFinds) {
  const Mesh mesh = relief(0.8).mesh;
  const TriangleTree tree(mesh);
  synthetic::Random random(4);
  for (int k = 0; k < 300; ++k) {
    const Vec3d p = random.vector().cwiseProduct(Vec3d(24, 16, 8));
    double best = 1e9;
    for (const auto& t : mesh.triangles) {
      best = std::min(best, nearest_on_triangle(p, mesh.vertices[t[0]].cast<double>(),
                                                mesh.vertices[t[1]].cast<double>(), mesh.vertices[t[2]].cast<double>())
                                .distance_mm);
    }
    ASSERT_TRUE(tree.nearest(p).has_value());
    EXPECT_DOUBLE_EQ(tree.nearest(p)->distance_mm, best);
    EXPECT_EQ(tree.nearest(p, best * 0.99).has_value(), false);
  }
}

TEST(TriangleTree, EveryFeatureOfATriangleIsExact) {
  const Vec3d a(0, 0, 0);
  const Vec3d b(2, 0, 0);
  const Vec3d c(0, 1, 0);
  const auto is = [&](const Vec3d& p, double distance, TriangleFeature feature) {
    const Nearest n = nearest_on_triangle(p, a, b, c);
    EXPECT_NEAR(n.distance_mm, distance, 1e-12);
    EXPECT_EQ(n.feature, feature);
  };
  is({-3, -4, 0}, 5, TriangleFeature::kVertex0);
  is({5, -4, 0}, 5, TriangleFeature::kVertex1);
  is({0, 3, 0}, 2, TriangleFeature::kVertex2);
  is({1, -2, 0}, 2, TriangleFeature::kEdge01);
  is({-2, 0.5, 0}, 2, TriangleFeature::kEdge20);
  is({2, 2, 0}, 4 / std::sqrt(5.0), TriangleFeature::kEdge12);
  is({0.2, 0.2, -7}, 7, TriangleFeature::kFace);
}

TEST(Compare, ABallTenMicrometresTooLargeDeviatesByPlusTen) {
  const CompareResult r = compared(ball(3.010).mesh, {ball(3.0)});
  EXPECT_NEAR(r.mean_abs_um, 10.0, 0.2);
  EXPECT_NEAR(r.median_um, 10.0, 0.2);
  EXPECT_NEAR(r.rms_um, 10.0, 0.2);
  EXPECT_NEAR(r.p99_um, 10.0, 0.4);
  EXPECT_NEAR(r.coverage_pct, 100.0, 1e-9);
}

TEST(Compare, OneTooSmallDeviatesByMinusTen) {
  const CompareResult r = compared(ball(2.990).mesh, {ball(3.0)});
  EXPECT_NEAR(r.median_um, -10.0, 0.15);
  EXPECT_NEAR(r.mean_abs_um, 10.0, 0.15);
}

TEST(Compare, SignsHoldAtSharpCornersOfSoupsWithoutSharedVertices) {
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

TEST(Compare, CoverageIsTheShareOfReferenceAreaAndAHoleIsMissed) {
  const MeshFile whole = relief(0.25);
  MeshFile mesh = whole;
  std::erase_if(mesh.mesh.triangles, [&](const auto& t) { return mesh.mesh.vertices[t[0]].x() > 0.0F; });
  const double expected = 100.0 * area(mesh.mesh) / area(whole.mesh);
  const double rim = 100.0 * 0.1 / 20.0;  // the reference within 0.1 mm beyond the cut is covered too
  const double covered = compared(mesh.mesh, {whole}).coverage_pct;
  EXPECT_GT(covered, expected);
  EXPECT_LT(covered, expected + 2.0 * rim);
}

TEST(Compare, OnlyWhatTheProbeSawCountsForCoverage) {
  MeshFile mesh = relief(0.25);
  std::erase_if(mesh.mesh.triangles, [&](const auto& t) { return mesh.mesh.vertices[t[0]].x() > 0.0F; });
  MeshFile reference = relief(0.25);
  for (const Vec3f& v : reference.mesh.vertices) {
    reference.vertex_values["seen"].push_back(v.x() < -0.2F ? 3.0F : 2.0F);
  }
  EXPECT_NEAR(compared(mesh.mesh, {reference}).coverage_pct, 100.0, 1e-9);
}

TEST(Compare, SeveralReferencesAreOneSurface) {
  MeshFile left = relief(0.25);
  MeshFile right = left;
  std::erase_if(left.mesh.triangles, [&](const auto& t) { return left.mesh.vertices[t[0]].x() > 1.0F; });
  std::erase_if(right.mesh.triangles, [&](const auto& t) { return right.mesh.vertices[t[0]].x() < -1.0F; });
  const Mesh mesh = relief(0.25).mesh;
  EXPECT_LT(compared(mesh, {left, right}).max_um, 0.01);
  EXPECT_GT(compared(mesh, {left}).max_um, 5000.0);
  EXPECT_GT(compared(mesh, {left}).beyond_border_pct, 30.0);
}

TEST(Compare, PercentilesFollowTheDistribution) {
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

TEST(Compare, BestFindsSmallAndLargeMotions) {
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

TEST(Compare, BestIsNotPulledByOutliers) {
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

TEST(Compare, StartLaysTheFirstPosesOnEachOtherAndTellsWhatIsLeftAtTheEnd) {
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

TEST(Compare, AnEstimateAThousandthTooLargeHasPositiveScale) {
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

TEST(Compare, StartNeedsPosesWithACommonBurst) {
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

TEST(Compare, JsonHasTheAgreedKeys) {
  const auto j = nlohmann::json::parse(compare_json(compared(relief(1.0).mesh, {relief(1.0)})));
  for (const char* key : {"mean_abs_um", "median_um", "rms_um", "p95_um", "p99_um", "max_um", "coverage_pct",
                          "end_error_um", "end_rotation_deg", "scale_ppm", "align"}) {
    EXPECT_TRUE(j.contains(key)) << key;
  }
  EXPECT_EQ(j["align"], "none");
  EXPECT_TRUE(j["end_error_um"].is_null());
}

TEST(DeviationPicture, ShowsBothSignsInTheirColours) {
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
