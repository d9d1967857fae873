// A scan there and back over an analytic surface, as tracking leaves it: a little off, and farther with every step.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "pipeline/register/map/refine_map.hpp"
#include "tests/unit/register/burst_times.hpp"
#include "tests/unit/register/synthetic_surface.hpp"

namespace enamel::pipeline {

struct DriftingScan {
  static constexpr int kBursts = 16;

  explicit DriftingScan(Pose (*as_tracked)(int) = tracked) {
    for (int n = 0; n < kBursts; ++n) {
      const auto seed = static_cast<std::uint64_t>(n);
      patches.push_back(testing::make_patch(surface, rig.camera, truth(n), {0.01, 0.03, seed}));
      input.bursts.push_back({time_of(n), as_tracked(n), BurstId{seed}});
    }
    input.load = [this](std::size_t n) { return patches[n]; };
  }
  DriftingScan(const DriftingScan&) = delete;
  DriftingScan& operator=(const DriftingScan&) = delete;

  /// 24 mm there and back again, turned a little on the way back.
  [[nodiscard]] static Pose truth(int n) {
    return testing::looking_down(3 * along(n), n < kBursts / 2 ? 0 : 1.5, {0, n < kBursts / 2 ? 0 : 0.1, 0});
  }
  /// Off by more on the way back, wherever it was.
  [[nodiscard]] static Pose tracked(int n) { return drifted(n, n); }
  /// Off on the way back as on the way there: laid on a model that is bent.
  [[nodiscard]] static Pose bent(int n) { return drifted(n, 2 * along(n)); }
  [[nodiscard]] static double error_mm(const Pose& T_model_cam, int n) {
    return testing::point_error_mm(truth(0) * T_model_cam, truth(n));
  }
  template <class PoseOf>
  [[nodiscard]] static double worst_mm(PoseOf&& pose_of) {
    double worst = 0;
    for (int n = 0; n < kBursts; ++n) worst = std::max(worst, error_mm(pose_of(n), n));
    return worst;
  }

 private:
  [[nodiscard]] static int along(int n) { return n < kBursts / 2 ? n : kBursts - 1 - n; }
  [[nodiscard]] static Pose drifted(int n, int steps) {
    const Pose drift(Eigen::Translation3d(0.002 * steps, 0.004 * steps, 0) *
                     Eigen::AngleAxisd(3e-4 * steps, Vec3d::UnitZ()));
    return truth(0).inverse() * drift * truth(n);
  }

 public:
  calib::Rig rig = testing::test_rig(2);
  testing::SyntheticSurface surface{61};
  std::vector<SurfacePatch> patches;
  MapInput input;
  MapConfig config;
};

}  // namespace enamel::pipeline
