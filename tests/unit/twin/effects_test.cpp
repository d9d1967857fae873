// Each switch changes the image in the direction that physics says; nothing else decides an image.
#include <tbb/global_control.h>

#include <algorithm>
#include <numeric>

#include "tests/unit/twin/twin_fixture.hpp"

namespace enamel::twin {
namespace {

using namespace testing;  // NOLINT: the fixture is this file's vocabulary
using Light = std::array<std::vector<float>, 4>;

Light light_of(const SceneConfig& scene, const calib::Rig& rig = small_rig()) {
  return source_of(scene, rig)->mean_light(0);
}

double mean(const std::vector<float>& v) {
  return std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
}

double mean_modulation(const Light& I) {
  double sum = 0;
  for (std::size_t i = 0; i < I[0].size(); ++i) {
    // Frames 0 and 1 with the mean of 0 and 2: free of the fourth frame's polarity.
    const double a = 0.5 * static_cast<double>(I[0][i] + I[2][i]);
    sum += std::hypot(static_cast<double>(I[0][i]) - a, static_cast<double>(I[1][i]) - a);
  }
  return sum / static_cast<double>(I[0].size());
}

/// Part of the pixels that are darker than a tenth of the mean in every frame.
double dark_share(const Light& I) {
  const double limit = 0.1 * mean(I[0]);
  int dark = 0;
  for (std::size_t i = 0; i < I[0].size(); ++i) {
    if (std::all_of(I.begin(), I.end(), [&](const auto& f) { return static_cast<double>(f[i]) < limit; })) ++dark;
  }
  return dark / static_cast<double>(I[0].size());
}

TEST(TwinEffects, shadow_darkens_behind_steps) {
  SceneConfig scene = plane_scene();
  scene.object = ObjectKind::kSteps;
  scene.effects = ideal();
  const double without = dark_share(light_of(scene));
  scene.effects.shadow = true;
  EXPECT_GT(dark_share(light_of(scene)), without + 0.01);
}

TEST(TwinEffects, shadow_rays_that_are_left_out_hardly_matter) {
  SceneConfig scene = plane_scene(48, 5, 0);
  scene.object = ObjectKind::kSteps;
  scene.effects = ideal();
  scene.effects.shadow = true;
  calib::Rig rig = probe_rig();  // at the probe's own pixel pitch
  rig.camera.height = 96;
  rig.camera.cy = 48;
  const auto fast = light_of(scene, rig);
  scene.render.every_shadow_ray = true;
  const auto full = light_of(scene, rig);
  const auto differ = [&](const Light& other) {
    int n = 0;
    for (std::size_t i = 0; i < full[0].size(); ++i) {
      if (std::abs(static_cast<double>(full[0][i] - other[0][i])) > 1e-3) ++n;
    }
    return n;
  };
  EXPECT_LE(differ(fast), static_cast<int>(full[0].size()) / 2000);
  scene.effects.shadow = false;  // control: there is shadow to be missed
  EXPECT_GT(differ(light_of(scene, rig)), static_cast<int>(full[0].size()) / 100);
}

TEST(TwinEffects, ambient_lightens_shadows) {
  SceneConfig scene = plane_scene();
  scene.object = ObjectKind::kSteps;
  scene.effects = ideal();
  scene.effects.shadow = true;
  const auto dark = light_of(scene);
  scene.effects.ambient = true;
  const auto lit = light_of(scene);
  EXPECT_NEAR(mean(lit[0]) - mean(dark[0]), 0.01 * 0.8, 0.002);
}

TEST(TwinEffects, falloff_dims_the_corner) {
  SceneConfig scene = plane_scene();
  scene.effects = ideal();
  const auto ratio = [](const Light& I) {
    double corner = 0, centre = 0;
    for (std::size_t y = 0; y < 20; ++y) {
      for (std::size_t x = 0; x < 20; ++x) {
        corner += static_cast<double>(I[0][y * 160 + x] + I[2][y * 160 + x]);
        centre += static_cast<double>(I[0][(50 + y) * 160 + 70 + x] + I[2][(50 + y) * 160 + 70 + x]);
      }
    }
    return corner / centre;
  };
  const double without = ratio(light_of(scene));
  scene.effects.falloff = true;
  EXPECT_LT(ratio(light_of(scene)), without - 0.03);
}

TEST(TwinEffects, defocus_and_point_spread_lower_the_modulation) {
  SceneConfig scene = plane_scene(41.5);
  scene.effects = ideal();
  const double sharp = mean_modulation(light_of(scene));
  scene.effects.defocus = true;
  const double defocused = mean_modulation(light_of(scene));
  EXPECT_LT(defocused, 0.97 * sharp);
  scene.effects.camera_psf = true;
  EXPECT_LT(mean_modulation(light_of(scene)), 0.98 * defocused);
}

TEST(TwinEffects, unlinearised_projector_darkens_the_mean) {
  SceneConfig scene = plane_scene();
  scene.effects = ideal();
  scene.projector.gamma = 2.2;
  scene.projector.lut_gamma = 1.0;
  const double linear = mean(light_of(scene)[0]);
  scene.effects.gamma = true;
  EXPECT_LT(mean(light_of(scene)[0]), 0.9 * linear);
  scene.projector.lut_gamma = 2.2;  // the table takes it out again
  EXPECT_NEAR(mean(light_of(scene)[0]), linear, 0.01 * linear);
}

TEST(TwinEffects, texture_mottles_the_albedo) {
  SceneConfig scene = plane_scene();
  scene.effects = ideal();
  scene.plane.grid_mm = 0.5;
  const auto plain = make_body(scene);
  scene.effects.texture = true;
  const auto mottled = make_body(scene);
  ASSERT_TRUE(plain && mottled);
  const auto range = [](const std::vector<float>& a) {
    const auto [lo, hi] = std::minmax_element(a.begin(), a.end());
    return static_cast<double>(*hi - *lo);
  };
  EXPECT_EQ(range(plain->surroundings.mesh.albedo), 0);
  EXPECT_NEAR(range(mottled->surroundings.mesh.albedo), 2 * 0.05 * 0.8, 0.03);
}

TEST(TwinEffects, motion_and_exposure_move_the_poses) {
  SceneConfig scene = plane_scene();
  scene.views[0].velocity_mm_s = {10, 0, 0};
  const calib::Rig rig = small_rig();
  const auto span = [&](const SceneConfig& s) {
    const auto p = source_of(s, rig)->poses(0);
    const double between = (p.frames[3].front().translation() - p.frames[0].front().translation()).norm();
    const double within = (p.frames[0].back().translation() - p.frames[0].front().translation()).norm();
    return std::pair{between, within};
  };
  const auto [between, within] = span(scene);
  EXPECT_NEAR(between, 10 * 3 * 4.004e-3, 1e-9);
  EXPECT_NEAR(within, 10 * 3.7e-3 * 0.75, 1e-9);
  scene.effects.exposure = false;
  EXPECT_EQ(span(scene).second, 0);
  scene.effects.motion = false;
  EXPECT_EQ(span(scene).first, 0);
  EXPECT_TRUE(source_of(scene, small_rig())->poses(0).is_static);
}

TEST(TwinEffects, without_distortion_the_rig_has_none) {
  SceneConfig scene = plane_scene(48, 10, 10);
  calib::Rig rig = probe_rig();
  scene.effects.lens_distortion = false;
  const auto effective = apply_effects(rig, scene.effects);
  ASSERT_TRUE(effective);
  for (const double d : effective->camera.dist) EXPECT_EQ(d, 0);
  for (const double d : effective->projector.dist) EXPECT_EQ(d, 0);
  EXPECT_NE(effective->text, rig.text);
  EXPECT_EQ(effective->camera.fx, rig.camera.fx);
}

TEST(TwinEffects, without_converter_samples_have_sixteen_bits) {
  SceneConfig scene = plane_scene();
  scene.effects.adc = false;
  const auto effective = apply_effects(probe_rig(), scene.effects);
  ASSERT_TRUE(effective);
  EXPECT_EQ(effective->noise->bits, 16);
  EXPECT_NEAR(effective->noise->gain_e_per_dn, 39.84 / 256, 1e-9);
  EXPECT_NEAR(effective->noise->black_dn, 4 * 256, 1e-9);
}

fw::SimBurst burst_of(const SceneConfig& scene, std::size_t threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  auto burst = source_of(scene, small_rig())->next();
  EXPECT_TRUE(burst && *burst);
  return **burst;
}

TEST(TwinDeterminism, threads_change_nothing_and_the_seed_everything) {
  SceneConfig scene = plane_scene();
  scene.object = ObjectKind::kJaw;
  scene.path = PathKind::kArch;
  scene.arch_path.passes = {{34, 44, 0, 5}};
  scene.jaw.max_edge_mm = 0.5;
  const auto one = burst_of(scene, 1), three = burst_of(scene, 3);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(one.frames[k], three.frames[k]);
  scene.seed = 2;
  const auto other = burst_of(scene, 2);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NE(one.frames[k], other.frames[k]);
}

TEST(TwinSource, stamps_and_counts_bursts) {
  SceneConfig scene = plane_scene();
  scene.views[0].bursts = 2;
  const auto source = source_of(scene, small_rig());
  EXPECT_EQ(source->count(), std::optional<std::uint64_t>(2));
  for (std::uint64_t n = 0; n < 2; ++n) {
    const auto burst = source->next();
    ASSERT_TRUE(burst && *burst);
    EXPECT_EQ((*burst)->burst_index, n);
    EXPECT_EQ((*burst)->t_exposure_ns[0], 1'000'000'000 + (n == 0 ? 0 : 33'333'333));
    EXPECT_EQ((*burst)->t_exposure_ns[3] - (*burst)->t_exposure_ns[0], 12'012'000);
    EXPECT_EQ((*burst)->exposure_us, 3700U);
    EXPECT_EQ((*burst)->frames[0].size(), 160U * 120U);
    EXPECT_EQ(source->truth().t_mid_ns, (*burst)->t_exposure_ns[0] + 7'856'000);
  }
  const auto end = source->next();
  ASSERT_TRUE(end);
  EXPECT_FALSE(end->has_value());
}

TEST(TwinSource, seen_counts_what_could_be_measured) {
  SceneConfig scene = plane_scene();
  scene.views[0].bursts = 3;
  scene.plane.grid_mm = 1.0;
  auto source = source_of(scene, small_rig());
  while (*source->next()) {
  }
  const auto& surface = source->surface();
  for (std::size_t i = 0; i < surface.vertices.size(); ++i) {
    const auto& v = surface.vertices[i];
    if (std::abs(v.x()) < 7 && std::abs(v.y()) < 5) {
      EXPECT_EQ(source->seen()[i], 3) << v.transpose();
    }
    if (std::abs(v.x()) > 11 || std::abs(v.y()) > 8) {
      EXPECT_EQ(source->seen()[i], 0) << v.transpose();
    }
  }
  scene.views[0].tilt_x_deg = 74;  // beyond 70 degrees nothing counts
  source = source_of(scene, small_rig());
  while (*source->next()) {
  }
  for (const auto n : source->seen()) EXPECT_EQ(n, 0);
}

}  // namespace
}  // namespace enamel::twin
