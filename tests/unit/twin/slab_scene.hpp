// A slab of one material before the small probe, and what its fringes look like through the renderer.
#pragma once

#include <vector>

#include "tests/unit/twin/twin_fixture.hpp"

namespace enamel::twin::testing {

/// The small probe with fringes of `period_mm` on the plane before it.
inline calib::Rig rig_with_period(double period_mm) {
  calib::Rig rig = small_rig();
  rig.patterns.mode = calib::PatternMode::kPlain4;
  const Pose pose = source_of(plane_scene(), rig)->poses(0).mid;
  const double u = rig.camera.cx, v = rig.camera.cy;
  const double px = plane_u(rig, pose, u + 1, v) - plane_u(rig, pose, u - 1, v);
  const double mm = (plane_point(rig, pose, u + 1, v) - plane_point(rig, pose, u - 1, v)).norm();
  rig.patterns.period_px = period_mm * std::abs(px) / mm;
  return rig;
}

/// Modulation over mean, and phase, in the middle of the picture.
struct Fringe {
  double modulation = 0;
  std::vector<double> phase;
};

inline Fringe fringe_of(const SceneConfig& scene, const calib::Rig& rig) {
  const auto I = source_of(scene, rig)->mean_light(0);
  Fringe out;
  int n = 0;
  for (int y = 50; y < 70; ++y) {
    for (int x = 60; x < 100; ++x, ++n) {
      const auto i = static_cast<std::size_t>(y * rig.camera.width + x);
      double mean = 0;
      for (const auto& frame : I) mean += 0.25 * static_cast<double>(frame[i]);
      out.modulation += 0.5 * static_cast<double>(std::hypot(I[3][i] - I[1][i], I[0][i] - I[2][i])) / mean;
      out.phase.push_back(phase4(I, i));
    }
  }
  out.modulation /= n;
  return out;
}

inline double mean_shift(const Fringe& a, const Fringe& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.phase.size(); ++i) sum += wrap(a.phase[i] - b.phase[i]);
  return sum / static_cast<double>(a.phase.size());
}

inline SceneConfig slab_of(MaterialId id, double surface_share) {
  SceneConfig scene = plane_scene();
  scene.effects = ideal();
  scene.effects.gloss = false;
  scene.look.material = static_cast<int>(id);
  scene.look.materials[index_of(id)].surface_share = surface_share;
  return scene;
}

}  // namespace enamel::twin::testing
