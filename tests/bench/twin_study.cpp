// What a plaster plane before the twin decodes to: noise at rest, ripple and velocity in motion.
#include "tests/bench/study.hpp"

#ifndef ENAMEL_WITH_TWIN

namespace enamel::bench {
Json twin_study() { return Json::object(); }
}  // namespace enamel::bench

#else

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

#include "pipeline/decode/burst_decoder.hpp"
#include "tools/twin/twin_source.hpp"

namespace enamel::bench {
namespace {

constexpr double kDistance_mm = 48, kSpeed = 20;  ///< of the motion, mm/s
constexpr double kDesignFill = 0.45;              ///< of full well: what the 8.5 um of the shot limit assume
constexpr int kBursts = 3;

template <class T>
T need(Result<T> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "%s\n", result.error().message().c_str());
  std::exit(exit_code(result.error().code));
}

/// A plane of plaster before the project's own probe, all effects on.
twin::SceneConfig plane_scene() {
  twin::SceneConfig scene = need(twin::load_scene(std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/plane.toml"));
  scene.views.resize(1);
  scene.views[0].distance_mm = kDistance_mm;
  scene.views[0].bursts = kBursts;
  return scene;
}

calib::Rig rig_of(const char* name) {
  return need(calib::load_rig(std::string(ENAMEL_SOURCE_DIR) + "/config/rigs/" + name));
}

fw::SimBurst next(twin::TwinSource& source) { return need(source.next()).value(); }

pipeline::DecodedBurst decode(const fw::SimBurst& burst, const pipeline::BurstDecoder& decoder) {
  pipeline::BurstView view{burst.width, burst.height, burst.bit_depth, {}};
  for (std::size_t k = 0; k < 4; ++k) view.frames[k] = burst.frames[k];
  return decoder.decode(view);
}

/// Depth less its least-squares plane z = a x + b y + c, mm; NaN where there is none.
Map<float> off_plane(const SurfacePatch& patch) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  const auto each = [&](auto visit) {
    for (std::size_t i = 0; i < patch.points.size(); ++i) {
      const Eigen::Vector3d p = patch.points[i].cast<double>();
      if (p.allFinite()) visit(i, Eigen::Vector3d(p.x(), p.y(), 1), p.z());
    }
  };
  each([&](std::size_t, const Eigen::Vector3d& a, double z) {
    normal += a * a.transpose(), right += a * (z - kDistance_mm);
  });
  const Eigen::Vector3d plane = normal.ldlt().solve(right);
  Map<float> out(patch.points.width(), patch.points.height(), std::nanf(""));
  each([&](std::size_t i, const Eigen::Vector3d& a, double z) {
    out[i] = static_cast<float>(z - kDistance_mm - a.dot(plane));
  });
  return out;
}

double rms_um(const Map<float>& map) {
  double sum = 0, n = 0;
  for (const float x : map.pixels())
    if (!std::isnan(x)) sum += static_cast<double>(x) * static_cast<double>(x), n += 1;
  return 1e3 * std::sqrt(sum / n);
}

/// Means of 5 x 5 pixels, all valid.
Map<float> smoothed(const Map<float>& map) {
  Map<float> out(map.width(), map.height(), std::nanf(""));
  for (int v = 2; v + 2 < map.height(); ++v) {
    for (int u = 2; u + 2 < map.width(); ++u) {
      float sum = 0;
      for (int j = -2; j <= 2; ++j)
        for (int i = -2; i <= 2; ++i) sum += map(u + i, v + j);
      out(u, v) = sum / 25;
    }
  }
  return out;
}

/// Amplitude, um, of what repeats twice a fringe: least squares on cos 2 phi and sin 2 phi.
double ripple_um(const Map<float>& residual, const Map<float>& phase_rad) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (std::isnan(residual[i]) || std::isnan(phase_rad[i])) continue;
    const double phi = 2 * static_cast<double>(phase_rad[i]);
    const Eigen::Vector2d a(std::cos(phi), std::sin(phi));
    normal += a * a.transpose(), right += a * static_cast<double>(residual[i]);
  }
  return 1e3 * normal.ldlt().solve(right).norm();
}

/// fill: mean light at the middle of the field as a part of full well, about; 0: as the twin is lit by itself.
Json at_rest(const char* rig_name, double fill) {
  twin::SceneConfig scene = plane_scene();
  if (fill > 0) scene.render.light.reference_mm = kDistance_mm, scene.render.light.reference_fraction = 2 * fill;
  const calib::Rig rig = rig_of(rig_name);
  const auto source = need(twin::TwinSource::create(scene, rig));
  const auto decoder = need(pipeline::BurstDecoder::make(rig));
  double raw = 0, smooth = 0, sigma = 0, mean = 0, contrast = 0, valid = 0;
  for (int k = 0; k < kBursts; ++k) {
    const auto burst = decode(next(*source), decoder);
    const Map<float> off = off_plane(burst.patch);
    raw = std::max(raw, rms_um(off));
    smooth = std::max(smooth, rms_um(smoothed(off)));
    sigma = std::max(sigma, rms_um(burst.patch.sigma_mm));
    valid = static_cast<double>(burst.patch.valid_px) / static_cast<double>(off.size());
    const std::size_t centre = off.index(rig.camera.width / 2, rig.camera.height / 2);
    mean = static_cast<double>(burst.patch.texture_dn[centre]);
    contrast = static_cast<double>(burst.patch.modulation_dn[centre]) / mean;
  }
  return {{"raw_um", raw},        {"mean_5x5_um", smooth},
          {"sigma_um", sigma},    {"fill", mean * rig.noise->gain_e_per_dn / rig.noise->full_well_e},
          {"contrast", contrast}, {"valid_pct", 100 * valid}};
}

/// Along the axis, per frame interval: of the rigid motion, or, where a mode fits none, by the mean rate of the phase.
double shift_mm(const pipeline::DecodeDiagnostics& seen, const pipeline::RayDepth& rays) {
  if (seen.rigid.moved) return std::abs(seen.rigid.shift_mm[2]);
  const std::size_t centre = static_cast<std::size_t>(rays.height / 2 * rays.width + rays.width / 2);
  const double inverse_per_rad = static_cast<double>(rays.c1[centre]);
  return std::abs(static_cast<double>(seen.motion_rad) * inverse_per_rad) * kDistance_mm * kDistance_mm;
}

Json in_motion(const char* rig_name, double frame_period_ms) {
  twin::SceneConfig scene = plane_scene();
  scene.timing.frame_period_ms = frame_period_ms;
  scene.timing.exposure_ms = frame_period_ms - 0.3;
  scene.views[0].velocity_mm_s = {0, 0, kSpeed};
  const calib::Rig rig = rig_of(rig_name);
  pipeline::DecodeConfig uncorrected;
  uncorrected.correct_closure = false;
  const auto ours = need(pipeline::BurstDecoder::make(rig)),
             plain = need(pipeline::BurstDecoder::make(rig, uncorrected));
  const auto source = need(twin::TwinSource::create(scene, rig));
  double with = 0, without = 0, off_mm_s = 0;
  bool accepted = true;
  for (int k = 0; k < kBursts; ++k) {
    const auto burst = next(*source);
    const auto a = decode(burst, ours), b = decode(burst, plain);
    accepted = accepted && a.accepted();
    with = std::max(with, ripple_um(off_plane(a.patch), a.phase_rad));
    without = std::max(without, ripple_um(off_plane(b.patch), b.phase_rad));
    const double seen_mm_s = shift_mm(a.diagnostics, ours.rays()) / (1e-3 * frame_period_ms);
    off_mm_s = std::max(off_mm_s, std::abs(seen_mm_s - kSpeed));
  }
  return {{"frame_period_ms", frame_period_ms}, {"speed_mm_s", kSpeed}, {"accepted", accepted},
          {"uncorrected_um", without},          {"ours_um", with},      {"velocity_error_mm_s", off_mm_s}};
}

}  // namespace

Json twin_study() {
  Json out;
  for (const auto& [mode, rig] : {std::pair{"T", "probe_t.json"}, {"M", "probe.json"}}) {
    out["plane"][mode] = at_rest(rig, 0);
    out["plane_full"][mode] = at_rest(rig, kDesignFill);
    for (const double period_ms : {2.8, 4.0}) out["motion"][mode].push_back(in_motion(rig, period_ms));
  }
  return out;
}

}  // namespace enamel::bench

#endif
