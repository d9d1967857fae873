// One tracker fed from an analytic surface by a hand that is known.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "pipeline/register/track/tracker.hpp"
#include "tests/unit/register/burst_times.hpp"
#include "tests/unit/register/synthetic_surface.hpp"

namespace enamel::testing {

/// A hand moving 10 mm/s along x with 60 µm of 9 Hz tremor and a slow turn.
inline Pose hand(double t_s) {
  const double wave = std::sin(2 * std::numbers::pi * 9 * t_s);
  return looking_down(10 * t_s, 0.06 * wave, {0.05 * t_s, 0.1 * t_s + 0.001 * wave, 0.03 * t_s}, 0.05 * wave);
}

/// One tracker fed from one surface. Poses are judged in the frame of the first burst's true pose.
class TrackSession {
 public:
  /// shrink: of the probe's pixels; 4 (160 x 120) is fast and coarse.
  explicit TrackSession(std::uint64_t surface_seed, int shrink = 4, const pipeline::TrackerConfig& config = {})
      : rig_(test_rig(shrink)), surface_(surface_seed), tracker_(rig_, config) {}

  TrackResult feed(int n, const Pose& truth, const ModelView& view = {}) { return feed(n, surface_, truth, view); }
  TrackResult feed(int n, const SyntheticSurface& surface, const Pose& truth, const ModelView& view = {}) {
    const auto id = static_cast<std::uint64_t>(n);
    return tracker_.track(BurstId{id}, pipeline::time_of(n),
                          make_patch(surface, rig_.camera, truth, {sigma_mm, 0.03, id + 100}), view);
  }
  [[nodiscard]] ModelView model_from(const Pose& truth) const {
    return view_in_frame(surface_, rig_.camera, truth, hand(0));
  }
  [[nodiscard]] static double error_mm(const TrackResult& r, const Pose& truth) {
    return point_error_mm(hand(0) * r.T_model_cam, truth);
  }
  [[nodiscard]] const pipeline::Tracker& tracker() const { return tracker_; }

  double sigma_mm = 0.01;

 private:
  calib::Rig rig_;
  SyntheticSurface surface_;
  pipeline::Tracker tracker_;
};

/// The search alone is asked: what it finds is taken without waiting for others that agree.
inline pipeline::TrackerConfig believing_one_vote() {
  pipeline::TrackerConfig config;
  config.join.votes = 1;
  return config;
}

}  // namespace enamel::testing
