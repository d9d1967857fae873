#include "pipeline/register/map/keyframe_choice.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace enamel::pipeline {
namespace {

double degrees_between(const Vec3d& a, const Vec3d& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0)) * 180 / std::numbers::pi;
}

bool is_near(const Pose& a, const Pose& b, double work_distance_mm, const MapConfig& config) {
  const Vec3d work(0, 0, work_distance_mm);
  const Eigen::AngleAxisd turn(a.linear().transpose() * b.linear());
  return (a * work - b * work).norm() < config.spacing_mm && turn.angle() < config.spacing_deg * std::numbers::pi / 180;
}

double seconds(DeviceTime from, DeviceTime to) { return 1e-9 * static_cast<double>((to - from).count()); }

}  // namespace

Gaze gaze_of(const Pose& T_model_cam, double work_distance_mm) {
  return {T_model_cam * Vec3d(0, 0, work_distance_mm), T_model_cam.linear().col(2)};
}

std::vector<std::size_t> choose_keyframes(const std::vector<MapBurst>& bursts, double work_distance_mm,
                                          const MapConfig& config) {
  std::vector<std::size_t> out;
  for (std::size_t n = 0; n < bursts.size(); ++n) {
    const Pose& T = bursts[n].T_model_cam;
    if (!out.empty() && is_near(bursts[out.back()].T_model_cam, T, work_distance_mm, config)) continue;
    const auto crowd = std::ranges::count_if(
        out, [&](std::size_t k) { return is_near(bursts[k].T_model_cam, T, work_distance_mm, config); });
    if (crowd < config.crowd) out.push_back(n);
  }
  return out;
}

std::vector<KeyframePair> choose_pairs(const std::vector<MapBurst>& bursts, const std::vector<std::size_t>& keyframes,
                                       double work_distance_mm, const MapConfig& config) {
  std::vector<Gaze> gazes;
  gazes.reserve(keyframes.size());
  for (const std::size_t k : keyframes) gazes.push_back(gaze_of(bursts[k].T_model_cam, work_distance_mm));
  std::vector<KeyframePair> out;
  for (std::size_t i = 1; i < keyframes.size(); ++i) {
    // j follows i backwards as long as nothing was missing in between.
    std::size_t unbroken = i;
    while (unbroken > 0 && i - unbroken < config.after &&
           seconds(bursts[keyframes[unbroken - 1]].t_mid, bursts[keyframes[unbroken]].t_mid) <= config.max_gap_s) {
      --unbroken;
    }
    std::vector<std::pair<double, std::size_t>> near;
    for (std::size_t j = 0; j < i; ++j) {
      const double apart = (gazes[i].point - gazes[j].point).norm();
      if (apart > config.reach_mm || degrees_between(gazes[i].axis, gazes[j].axis) > config.reach_deg) continue;
      if (j >= unbroken) {
        out.push_back({i, j, i - j > 1});
      } else {
        near.emplace_back(apart, j);
      }
    }
    std::ranges::sort(near);
    near.resize(std::min(near.size(), config.others));
    for (const auto& [apart, j] : near) out.push_back({i, j, true});
  }
  std::ranges::sort(out,
                    [](const KeyframePair& a, const KeyframePair& b) { return a.i != b.i ? a.i < b.i : a.j < b.j; });
  return out;
}

}  // namespace enamel::pipeline
