// Whole renders against closed forms: hits, phase on a plane, ripple of motion, slanted edge.
#include "tests/unit/twin/twin_fixture.hpp"

namespace enamel::twin {
namespace {

using namespace testing;  // NOLINT: the fixture is this file's vocabulary

/// Largest distance between the truth map's points and the analytic plane at `pose`, mm along the ray's z.
double worst_plane_error(const TwinSource& source, const TruthMaps& maps, const Pose& pose) {
  const calib::Rig& rig = source.rig();
  double worst = 0;
  for (int y = 0; y < rig.camera.height; ++y) {
    for (int x = 0; x < rig.camera.width; ++x) {
      const double z = plane_point(rig, pose, x, y).z();
      const auto i = static_cast<std::size_t>(y * rig.camera.width + x);
      worst = std::max(worst, std::abs(static_cast<double>(maps.depth[i]) - z));
    }
  }
  return worst;
}

TEST(TwinPhysics, plane_hits_agree_with_the_closed_form) {
  const auto source = source_of(plane_scene(47, 25, -18), small_rig());
  ASSERT_TRUE(source->next());
  const BurstTruth& truth = source->truth();
  EXPECT_LE(worst_plane_error(*source, truth.maps, truth.T_model_cam), 0.05e-3);
  Pose wrong = truth.T_model_cam;  // control: one micrometre off is noticed
  wrong.translation().z() += 1e-3;
  EXPECT_GT(worst_plane_error(*source, truth.maps, wrong), 0.05e-3);
}

TEST(TwinPhysics, sphere_hits_agree_with_the_closed_form) {
  SceneConfig scene = plane_scene();
  scene.object = ObjectKind::kSpheres;
  const auto source = source_of(scene, small_rig());
  ASSERT_TRUE(source->next());
  const Pose T_cam_model = source->truth().T_model_cam.inverse();
  const calib::Rig& rig = source->rig();
  int checked = 0;
  for (const auto& [x, radius] : {std::pair{-4.0, 2.5}, {4.0, 3.0}}) {
    const Eigen::Vector3d c = T_cam_model * Eigen::Vector3d(x, 0, 0);
    for (int i = 0; i < rig.camera.width * rig.camera.height; ++i) {
      const int u = i % rig.camera.width, v = i / rig.camera.width;
      const Eigen::Vector3d d = pixel_ray(rig.camera, u, v);
      const double b = d.dot(c), q = b * b - d.squaredNorm() * (c.squaredNorm() - radius * radius);
      const double rim = 0.5;  // the rod and the silhouette are not this test's matter
      const double t = (b - std::sqrt(std::max(q, 0.0))) / d.squaredNorm();
      const double z_model = (source->truth().T_model_cam * (t * d)).z();
      if (q < rim || z_model < 1.0) continue;
      EXPECT_NEAR(static_cast<double>(source->truth().maps.depth[static_cast<std::size_t>(i)]), t, 0.05e-3);
      ++checked;
    }
  }
  EXPECT_GT(checked, 1500);
}

struct PhaseError {
  double worst = 0;
  int wrong_orders = 0, wrong_polarities = 0, pixels = 0;
};

/// Three frames give the phase in every mode, the fourth its sign.
PhaseError phase_error(const TwinSource& source) {
  const auto I = source.mean_light(0);
  const calib::Rig& rig = source.rig();
  const Pose pose = source.poses(0).mid;
  const TruthMaps& maps = source.truth().maps;
  PhaseError out;
  constexpr int kBorder = 4;  // the point spread has no neighbours there
  for (int y = kBorder; y < rig.camera.height - kBorder; ++y) {
    for (int x = kBorder; x < rig.camera.width - kBorder; ++x) {
      const auto i = static_cast<std::size_t>(y * rig.camera.width + x);
      if (maps.lit[i] == 0) continue;
      const double u = plane_u(rig, pose, x, y), phi = 2 * kPi * u / rig.patterns.period_px;
      const double I0 = static_cast<double>(I[0][i]), I1 = static_cast<double>(I[1][i]);
      const double I2 = static_cast<double>(I[2][i]), I3 = static_cast<double>(I[3][i]);
      const double A = 0.5 * (I0 + I2), C = 0.5 * (I0 - I2), S = A - I1;
      out.worst = std::max(out.worst, std::abs(wrap(std::atan2(S, C) - phi)));
      if (maps.order[i] != static_cast<int>(std::floor(u / rig.patterns.period_px))) ++out.wrong_orders;
      ++out.pixels;
      const double to_flip = std::abs(std::remainder(phi, kPi));
      if (to_flip < 1.0) continue;
      const auto cell = static_cast<std::size_t>(std::floor(phi / kPi)) % rig.patterns.polarity_code.size();
      if ((I3 - A) * S * rig.patterns.polarity_code[cell] <= 0) ++out.wrong_polarities;
    }
  }
  return out;
}

TEST(TwinPhysics, phase_on_a_plane_is_that_of_the_closed_form) {
  SceneConfig scene = plane_scene(48, 8, -6);
  scene.effects = ideal();
  // Falloff stays off: light that changes across the point spread moves the phase by sigma^2 phi' B'/B, 1e-4 rad, in a
  // real probe as well; the closed form has no such term.
  scene.effects.camera_psf = scene.effects.defocus = scene.effects.shadow = true;
  // The fringe's slope on the small camera is four times the probe's: the probe's own pixel pitch is kept instead.
  calib::Rig rig = probe_rig();
  rig.camera.height = 48;
  rig.camera.cy = 20;
  auto source = source_of(scene, rig);
  ASSERT_TRUE(source->next());
  const PhaseError clean = phase_error(*source);
  EXPECT_GT(clean.pixels, 20000);
  EXPECT_LE(clean.worst, 1e-4);
  EXPECT_EQ(clean.wrong_orders, 0);
  EXPECT_EQ(clean.wrong_polarities, 0);
  scene.effects.round_levels = true;  // control: 8-bit pattern levels break it
  source = source_of(scene, rig);
  ASSERT_TRUE(source->next());
  EXPECT_GT(phase_error(*source).worst, 3e-4);
}

/// Slope of (measured - true phase) over (epsilon / 2) cos 2 phi: 1 for constant motion along the axis, 0 at rest.
double ripple_ratio(bool motion) {
  SceneConfig scene = plane_scene();
  scene.views[0].velocity_mm_s = {0, 0, 20};
  scene.effects = ideal();
  scene.effects.motion = scene.effects.exposure = motion;
  calib::Rig rig = probe_rig();
  rig.camera.height = 24;
  rig.camera.cy = 10;
  rig.patterns.mode = calib::PatternMode::kPlain4;
  const auto source = source_of(scene, rig);
  const auto I = source->mean_light(0);
  const Pose mid = source->poses(0).mid;
  Pose later = mid;
  later.translation() += mid.linear() * Eigen::Vector3d(0, 0, 20 * 4.004e-3);
  double num = 0, den = 0;
  for (int y = 0; y < rig.camera.height; ++y) {
    for (int x = 0; x < rig.camera.width; ++x) {
      const double phi = 2 * kPi * plane_u(rig, mid, x, y) / rig.patterns.period_px;
      const double epsilon = 2 * kPi * plane_u(rig, later, x, y) / rig.patterns.period_px - phi;
      const double model = 0.5 * epsilon * std::cos(2 * phi);
      num += model * wrap(phase4(I, static_cast<std::size_t>(y * rig.camera.width + x)) - phi);
      den += model * model;
    }
  }
  return num / den;
}

TEST(TwinPhysics, motion_ripples_by_half_the_phase_step) {
  EXPECT_NEAR(ripple_ratio(true), 1.0, 0.03);
  EXPECT_NEAR(ripple_ratio(false), 0.0, 1e-3);
}

/// A half plane of other reflectance, its edge turned by `angle` from the image's v axis.
TriSurface edge_card(double angle) {
  TriSurface card;
  const Eigen::Vector3f along(static_cast<float>(std::sin(angle)), static_cast<float>(std::cos(angle)), 0);
  const Eigen::Vector3f across(along.y(), -along.x(), 0);
  for (const float side : {-1.0F, 1.0F}) {
    const auto first = static_cast<std::uint32_t>(card.vertices.size());
    for (const float s : {-30.0F, 30.0F}) {
      card.vertices.emplace_back(s * along);
      card.vertices.emplace_back(s * along + side * 30.0F * across);
      for (int k = 0; k < 2; ++k) card.albedo.push_back(side < 0 ? 0.2F : 0.8F);
    }
    if (side > 0) {
      card.triangles.push_back({first, first + 1, first + 2});
      card.triangles.push_back({first + 2, first + 1, first + 3});
    } else {
      card.triangles.push_back({first, first + 2, first + 1});
      card.triangles.push_back({first + 2, first + 3, first + 1});
    }
  }
  card.normals.assign(card.vertices.size(), Eigen::Vector3f::UnitZ());
  return card;
}

/// Modulation transfer of an edge image at f cycles/px, by projecting pixels onto the edge's normal (ISO 12233).
std::vector<double> edge_mtf(const std::vector<float>& image, int width, int height, double angle, double centre_u,
                             double centre_v, const std::vector<double>& frequencies) {
  constexpr int kBinsPerPx = 8, kHalfPx = 12, kBins = 2 * kHalfPx * kBinsPerPx;
  std::vector<double> sum(kBins, 0), count(kBins, 0);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      // Image v points against model y, so the edge leans the other way in the image.
      const double d = (x - centre_u) * std::cos(angle) + (y - centre_v) * std::sin(angle);
      const int bin = static_cast<int>(std::floor((d + kHalfPx) * kBinsPerPx));
      if (bin < 0 || bin >= kBins) continue;
      sum[static_cast<std::size_t>(bin)] += static_cast<double>(image[static_cast<std::size_t>(y * width + x)]);
      count[static_cast<std::size_t>(bin)] += 1;
    }
  }
  std::vector<double> out;
  for (const double f : frequencies) {
    double re = 0, im = 0, dc = 0;
    for (std::size_t i = 1; i < kBins; ++i) {
      const double step = sum[i] / count[i] - sum[i - 1] / count[i - 1];
      const double at = static_cast<double>(i) / kBinsPerPx - kHalfPx;
      re += step * std::cos(2 * kPi * f * at);
      im += step * std::sin(2 * kPi * f * at);
      dc += step;
    }
    const double bin = kPi * f / kBinsPerPx;
    out.push_back(std::hypot(re, im) / dc / (std::sin(bin) / bin));  // the bins' own width taken out
  }
  return out;
}

TEST(TwinPhysics, slanted_edge_has_the_specified_transfer_function) {
  calib::Rig rig = small_rig();
  rig.camera.dist = {};
  rig.camera.fx = rig.camera.fy = 1707;
  rig.camera.cx = 79.5;
  rig.camera.cy = 59.5;
  rig.patterns.mode = calib::PatternMode::kPlain4;
  rig.patterns.amplitude = 0;  // uniform light
  ProjectorConfig projector;
  projector.gamma = projector.lut_gamma = 1;
  const Instrument instrument(rig, projector);
  const double angle = 5.0 * kPi / 180;
  const RayScene card({edge_card(angle), {}});
  RenderConfig config;
  config.grid = 4;
  config.light.falloff = config.light.shadow = false;
  const BurstRenderer renderer(instrument, card, config);
  BurstPoses poses;
  poses.mid = Pose(Eigen::Translation3d(0, 0, 48)) * Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX());
  poses.is_static = true;
  auto image = renderer.render(poses)[0];
  const double sigma = 0.6;
  apply_psf(image, 160, 120, sigma);
  std::vector<double> frequencies;
  for (double f = 0.05; f <= 0.4; f += 0.05) frequencies.push_back(f);
  const auto mtf = edge_mtf(image, 160, 120, angle, 79.5, 59.5, frequencies);
  for (std::size_t i = 0; i < mtf.size(); ++i) {
    // Pixel aperture and discrete Gaussian, along both image axes.
    double expected = 1;
    for (const double f : {frequencies[i] * std::cos(angle), frequencies[i] * std::sin(angle)}) {
      double kernel = 0, norm = 0;
      for (int n = -3; n <= 3; ++n) {
        const double w = std::exp(-0.5 * n * n / (sigma * sigma));
        kernel += w * std::cos(2 * kPi * f * n);
        norm += w;
      }
      expected *= kernel / norm * std::sin(kPi * f) / (kPi * f);
    }
    EXPECT_NEAR(mtf[i] / expected, 1.0, 0.02) << "at " << frequencies[i] << " cycles/px";
  }
}

/// A fringe that the border cuts goes on beyond it on a real sensor.
TEST(PointSpread, leaves_the_phase_of_a_fringe_at_the_border) {
  constexpr int kSize = 40;
  constexpr double kPerPx = 2 * kPi / 25;
  const auto diagonal_of = [](int i) { return i % kSize + i / kSize; };
  std::array<std::vector<float>, 4> frames;
  for (std::size_t k = 0; k < 4; ++k) {
    for (int i = 0; i < kSize * kSize; ++i) {
      const double phase = kPerPx * diagonal_of(i) + 0.5 * kPi * static_cast<double>(k);
      frames[k].push_back(static_cast<float>(100 + 60 * std::cos(phase)));
    }
    apply_psf(frames[k], kSize, kSize, 0.6);
  }
  for (int i = 0; i < kSize * kSize; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double seen = std::atan2(static_cast<double>(frames[3][at] - frames[1][at]),
                                   static_cast<double>(frames[0][at] - frames[2][at]));
    const double off = std::remainder(seen - kPerPx * diagonal_of(i), 2 * kPi);
    ASSERT_LT(std::abs(off), 0.002) << i % kSize << ' ' << i / kSize;  // 0.06 where half the spread were cut off
  }
}

}  // namespace
}  // namespace enamel::twin
