// Drawn balls with drawn noise on a plate: centre, diameter, form and distance as planted, within what the noise
// allows.
#include "host/accuracy/balls.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "host/accuracy/artefact_figures.hpp"
#include "tests/unit/host/mesh_shapes.hpp"

namespace enamel::host {
namespace {

struct Planted {
  Vec3d centre;
  double diameter_mm, sigma_mm;
  double squeezed_mm = 0;                                ///< the diameter across is larger by this
  double outliers = 0;                                   ///< share of points that stand out by 60 um
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  ///< of centre and radius: sigma^2 (J' J)^-1, once added
};

void add(Mesh& mesh, const Mesh& more) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const auto& t : more.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

/// The part of the ball that a probe sees from +z and both sides.
void add(Mesh& mesh, Planted& planted, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> share(0, 1);
  Mesh whole = ball(planted.diameter_mm / 2, 160).mesh;
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  std::vector<bool> is_seen;
  for (Vec3f& v : whole.vertices) {
    const Vec3d n = v.cast<double>().normalized();
    is_seen.push_back(n.z() > -0.3);
    double off = planted.sigma_mm * normal(random) + 0.5 * planted.squeezed_mm * n.x() * n.x();
    if (share(random) < planted.outliers) off += 0.06;
    v = (planted.centre + v.cast<double>() + off * n).cast<float>();
    if (!is_seen.back()) continue;
    const Eigen::Vector4d J(n.x(), n.y(), n.z(), 1);
    A += J * J.transpose();
  }
  std::erase_if(whole.triangles,
                [&](const auto& t) { return std::ranges::any_of(t, [&](std::uint32_t v) { return !is_seen[v]; }); });
  planted.covariance = planted.sigma_mm * planted.sigma_mm * A.inverse();
  add(mesh, whole);
}

Mesh plate() {
  return grid(200, 100, [](double a, double b) { return Vec3d(80 * a - 10, 40 * b - 20, 0); }).mesh;
}

/// Trimming loses some of the points, and normals at the border some: a quarter more than the bound, four times that.
constexpr double kSigmas = 5;
double centre_limit(const Planted& p) { return kSigmas * std::sqrt(p.covariance.topLeftCorner<3, 3>().trace()); }
double diameter_limit(const Planted& p) { return kSigmas * 2 * std::sqrt(p.covariance(3, 3)); }

struct Scene {
  std::vector<Planted> balls;
  pipeline::KnownArtefact artefact;
  AccuracyRun run{"drawn", {}};
};

Scene drawn_scene(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Scene out;
  out.run.file.mesh = plate();
  for (int i = 0; i < 3; ++i) {
    const double diameter = i == 0 ? 8 : 5 + uniform(random);
    out.artefact.diameters_mm.push_back(diameter);
    out.balls.push_back({.centre = Vec3d(25 * i + 3 * uniform(random), 10 * uniform(random), 5),
                         .diameter_mm = diameter + 0.04 * (uniform(random) - 0.5),
                         .sigma_mm = 1e-3 * (2 + 6 * uniform(random))});
    add(out.run.file.mesh, out.balls.back(), random);
  }
  const auto apart = [&](std::size_t i, std::size_t j) { return (out.balls[i].centre - out.balls[j].centre).norm(); };
  for (const auto& [i, j] : {std::pair{0U, 1U}, {0U, 2U}, {1U, 2U}})
    out.artefact.distances.push_back({i, j, apart(i, j), 0.001});
  return out;
}

TEST(Balls, are_found_where_they_were_planted) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Scene scene = drawn_scene(seed);
    for (std::size_t i = 0; i < scene.balls.size(); ++i) {
      const Planted& planted = scene.balls[i];
      const auto found = find_balls(scene.run.file.mesh, scene.artefact.diameters_mm[i]);
      const auto it =
          std::ranges::find_if(found, [&](const FittedBall& b) { return (b.centre - planted.centre).norm() < 0.5; });
      ASSERT_NE(it, found.end()) << seed << " ball " << i;
      EXPECT_LT((it->centre - planted.centre).norm(), centre_limit(planted)) << seed;
      EXPECT_NEAR(it->diameter_mm, planted.diameter_mm, diameter_limit(planted)) << seed;
      EXPECT_NEAR(it->form_mm, 2 * 1.96 * planted.sigma_mm, 0.15 * 2 * 1.96 * planted.sigma_mm) << seed;
      EXPECT_NEAR(it->share, 0.65, 0.05) << seed;
    }
  }
}

TEST(Balls, outliers_do_not_draw_the_fit) {
  std::mt19937_64 random(31);
  Planted planted{.centre = {4, 2, 5}, .diameter_mm = 7, .sigma_mm = 0.003, .outliers = 0.03};
  Mesh mesh = plate();
  add(mesh, planted, random);
  const auto found = find_balls(mesh, 7);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].diameter_mm, 7, diameter_limit(planted));
  EXPECT_LT((found[0].centre - planted.centre).norm(), centre_limit(planted));
  // Control: without trimming they do, by some share of what they stand out.
  const auto drawn = find_balls(mesh, 7, {.trim_sigmas = 1e6});
  ASSERT_EQ(drawn.size(), 1U);
  EXPECT_GT(drawn[0].diameter_mm - 7, diameter_limit(planted));
}

TEST(Balls, one_that_is_not_round_shows_in_its_form) {
  std::mt19937_64 random(32);
  Planted planted{.centre = {4, 2, 5}, .diameter_mm = 7, .sigma_mm = 0.002, .squeezed_mm = 0.08};
  Mesh mesh = plate();
  add(mesh, planted, random);
  const auto found = find_balls(mesh, 7);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_GT(found[0].form_mm, 2 * 2 * 1.96 * planted.sigma_mm);
}

TEST(Balls, none_is_found_where_there_is_none) {
  EXPECT_TRUE(find_balls(plate(), 7).empty());
  EXPECT_TRUE(find_balls(relief(0.1).mesh, 7).empty());
  EXPECT_TRUE(find_balls({}, 7).empty());
  EXPECT_TRUE(find_balls(ball(4).mesh, 7).empty());  // of another size
}

TEST(ArtefactFigures, are_the_planted_errors) {
  for (std::uint64_t seed = 41; seed <= 44; ++seed) {
    Scene scene = drawn_scene(seed);
    scene.artefact.distances[0].mm += 0.02;  // an error of the scan, seen from the certificate
    const auto figures = artefact_figures(scene.run, scene.artefact);
    ASSERT_TRUE(figures) << figures.error().message();
    for (std::size_t i = 0; i < scene.balls.size(); ++i) {
      EXPECT_NEAR(figures->size_um[i], 1e3 * (scene.balls[i].diameter_mm - scene.artefact.diameters_mm[i]),
                  1e3 * diameter_limit(scene.balls[i]));
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& d = scene.artefact.distances[k];
      const double limit = std::hypot(centre_limit(scene.balls[d.i]), centre_limit(scene.balls[d.j]));
      EXPECT_NEAR(figures->distance_um[k], k == 0 ? -20 : 0, 1e3 * limit);
    }
  }
}

TEST(ArtefactFigures, equal_balls_are_told_apart_by_their_distances) {
  std::mt19937_64 random(51);
  AccuracyRun run{"equal", {plate(), {}, Vec3d::Zero(), 0, {}}};
  std::vector<Planted> balls;
  for (const double x : {0.0, 14.0, 40.0}) {
    balls.push_back({.centre = {x, 0, 5}, .diameter_mm = 6, .sigma_mm = 0.002});
    add(run.file.mesh, balls.back(), random);
  }
  const pipeline::KnownArtefact artefact{.diameters_mm = {6, 6, 6},
                                         .distances = {{0, 1, 26, 0.001}, {1, 2, 14, 0.001}, {0, 2, 40, 0.001}}};
  const auto figures = artefact_figures(run, artefact);
  ASSERT_TRUE(figures) << figures.error().message();
  EXPECT_NEAR(figures->balls[0].centre.x(), 40, 0.01);
  EXPECT_NEAR(figures->balls[1].centre.x(), 14, 0.01);
  EXPECT_NEAR(figures->balls[2].centre.x(), 0, 0.01);
}

TEST(ArtefactFigures, another_artefact_is_refused) {
  Scene scene = drawn_scene(61);
  ASSERT_TRUE(artefact_figures(scene.run, scene.artefact));  // control
  pipeline::KnownArtefact longer = scene.artefact;
  longer.distances[1].mm += 1;
  const auto apart = artefact_figures(scene.run, longer);
  ASSERT_FALSE(apart);
  EXPECT_NE(apart.error().detail.find("certified distances"), std::string::npos);
  pipeline::KnownArtefact larger = scene.artefact;
  larger.diameters_mm[0] += 1.5;
  const auto missing = artefact_figures(scene.run, larger);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kMeshInvalid);
  EXPECT_NE(missing.error().detail.find("sphere 0"), std::string::npos);
}

}  // namespace
}  // namespace enamel::host
