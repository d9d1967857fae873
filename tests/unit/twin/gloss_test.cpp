// Mirror light and saliva against closed forms and an own Snell.
#include "tests/unit/twin/twin_fixture.hpp"
#include "tools/twin/render/facet_mirror.hpp"

namespace enamel::twin {
namespace {

using namespace testing;  // NOLINT: the fixture is this file's vocabulary

/// Share of the light from `cosine` that facets of a perfect mirror send anywhere.
double reflected_share(double alpha, double cosine) {
  const Vec3d n = Vec3d::UnitZ(), light(std::sqrt(1 - cosine * cosine), 0, cosine);
  constexpr int kSteps = 400;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      // By the cosine-weighted hemisphere: share = mean of pi f_r, and facet_mirror is pi f_r cos(light).
      const double r2 = (i + 0.5) / kSteps, phi = 2 * kPi * (j + 0.5) / kSteps;
      const Vec3d out(std::sqrt(r2) * std::cos(phi), std::sqrt(r2) * std::sin(phi), std::sqrt(1 - r2));
      sum += facet_mirror(n, light, out, alpha, 1.0) / cosine;
    }
  }
  return sum / (kSteps * kSteps);
}

TEST(FacetMirror, sends_back_no_more_than_it_gets) {
  EXPECT_NEAR(reflected_share(0.1, 0.9), 1.0, 0.02);
  EXPECT_NEAR(reflected_share(0.3, 0.9), 0.87, 0.02);  // what bounces twice, or down, is lost
  EXPECT_LE(reflected_share(0.8, 0.5), 1.0);
  EXPECT_EQ(facet_mirror(Vec3d::UnitZ(), Vec3d(0, 0, -1), Vec3d::UnitZ(), 0.3, 1.0), 0);  // control: from below
}

TEST(FacetMirror, refraction_is_snells) {
  const double angle = 0.6;
  const auto t = refract(Vec3d(std::sin(angle), 0, std::cos(angle)), Vec3d::UnitZ(), 1 / 1.33);
  ASSERT_TRUE(t);
  EXPECT_NEAR(-t->x(), std::sin(angle) / 1.33, 1e-12);
  EXPECT_NEAR(t->norm(), 1, 1e-12);
  EXPECT_FALSE(refract(Vec3d(std::sin(1.2), 0, std::cos(1.2)), Vec3d::UnitZ(), 1.33));  // control: all reflected
}

double brightest(const SceneConfig& scene) {
  const auto I = source_of(scene, small_rig())->mean_light(0);
  return static_cast<double>(*std::max_element(I[0].begin(), I[0].end()));
}

TEST(TwinGloss, a_metal_plane_blinds_where_it_mirrors) {
  SceneConfig scene = plane_scene(48, 0, 6);
  scene.look.material = static_cast<int>(MaterialId::kMetal);
  const double away = 35, mirrors = scene.views[0].tilt_y_deg;
  double glare = 0;
  for (const double tilt : {mirrors, -mirrors}) {  // the projector stands on one side
    scene.views[0].tilt_y_deg = tilt;
    glare = std::max(glare, brightest(scene));
  }
  EXPECT_GT(glare, 1.0);  // beyond the full well
  scene.views[0].tilt_y_deg = away;
  EXPECT_LT(brightest(scene), 0.3 * glare);
  scene.effects.gloss = false;  // control
  scene.views[0].tilt_y_deg = mirrors;
  EXPECT_LT(brightest(scene), 0.1);
}

/// A plane of plaster, dry or under a level film, in plain fringes without noise.
std::array<std::vector<float>, 4> pool_light(const calib::Rig& rig, const Pose& pose, float film_mm) {
  PlaneConfig plane;
  plane.grid_mm = 2;
  Surroundings body = make_plane(plane);
  if (film_mm > 0) body.mesh.film.assign(body.mesh.vertices.size(), Film{film_mm, 1});
  ProjectorConfig projector;
  projector.round_levels = false;
  projector.gamma = projector.lut_gamma = 1;
  const Instrument instrument(rig, projector);
  const RayScene scene(std::move(body));
  RenderConfig config;
  config.light.falloff = config.light.shadow = false;
  config.light.ambient = 0;
  BurstPoses poses;
  poses.mid = pose;
  poses.is_static = true;
  return BurstRenderer(instrument, scene, config).render(poses);
}

/// Projector coordinate that lights the bottom seen at a pixel through water of depth h over the plane z = 0: the
/// camera's ray by Snell, the projector's by bisection.
double wet_u(const calib::Rig& rig, const Pose& pose, double u, double v, double h) {
  const double n = 1.33;
  const Vec3d camera = pose.translation(), d = (pose.linear() * pixel_ray(rig.camera, u, v)).normalized();
  const Vec3d top = camera + d * ((h - camera.z()) / d.z());
  const double sine = d.head<2>().norm() / n, tangent = sine / std::sqrt(1 - sine * sine);
  const Eigen::Vector2d bottom = top.head<2>() + h * tangent * d.head<2>().normalized();
  const Vec3d light = pose * T_proj_cam(rig).inverse().translation();
  const Eigen::Vector2d across = light.head<2>() - bottom;
  const double reach = across.norm();
  double low = 0, high = h;  // how far from above the bottom the light enters
  for (int i = 0; i < 60; ++i) {
    const double x = 0.5 * (low + high);
    const double outside = (reach - x) / std::hypot(reach - x, light.z() - h), inside = x / std::hypot(x, h);
    (outside > n * inside ? low : high) = x;
  }
  const Eigen::Vector2d entry = bottom + low * across / reach;
  return project(rig.projector, T_proj_cam(rig) * (pose.inverse() * Vec3d(entry.x(), entry.y(), h))).x();
}

TEST(TwinFilm, a_pool_lifts_its_bottom_as_snell_says) {
  calib::Rig rig = probe_rig();
  rig.camera.height = 24;
  rig.camera.cy = 10;
  rig.patterns.mode = calib::PatternMode::kPlain4;
  const Pose tilted = source_of(plane_scene(48, 25, 0), rig)->poses(0).mid;  // out of the glare
  constexpr float kDepthMm = 0.3F;
  const auto wet = pool_light(rig, tilted, kDepthMm), dry = pool_light(rig, tilted, 0);
  double worst = 0, shift = 0;
  for (int y = 4; y < 20; y += 3) {
    for (int x = 100; x < 540; x += 20) {
      const auto i = static_cast<std::size_t>(y * rig.camera.width + x);
      const double to_px = rig.patterns.period_px / (2 * kPi);
      const double expected = wet_u(rig, tilted, x, y, static_cast<double>(kDepthMm)) - plane_u(rig, tilted, x, y);
      const double seen = wrap(phase4(wet, i) - phase4(dry, i)) * to_px;
      worst = std::max(worst, std::abs(seen - expected));
      shift = std::max(shift, std::abs(expected));
    }
  }
  EXPECT_GT(shift, 0.3);
  EXPECT_LT(worst, 0.06);
}

TEST(TwinFilm, glare_of_a_film_and_none_of_a_dry_surface) {
  SceneConfig scene = plane_scene(48, 0, 6);
  scene.look.film.wet_share = 1;
  double glare = 0;
  for (const double tilt : {6.0, -6.0}) {
    scene.views[0].tilt_y_deg = tilt;
    glare = std::max(glare, brightest(scene));
  }
  scene.effects.film = false;  // control
  EXPECT_GT(glare, 1.2 * brightest(scene));
  scene.effects.film = true;
  scene.look.film.roughness = 0.5;  // wide and weak
  EXPECT_GT(glare, 1.2 * brightest(scene));
}

}  // namespace
}  // namespace enamel::twin
