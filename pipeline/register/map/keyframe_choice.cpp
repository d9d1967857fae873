#include "pipeline/register/map/keyframe_choice.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/register/icp/seconds.hpp"
#include "pipeline/types/viewpoint.hpp"

namespace enamel::pipeline {
namespace {

double degrees_between(const Vec3d& a, const Vec3d& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0)) * 180 / std::numbers::pi;
}

/// Where a camera looks at, and from where.
struct Gaze {
  Vec3d point, axis;
};

}  // namespace

std::vector<std::size_t> choose_keyframes(const std::vector<MapBurst>& bursts, double work_distance_mm,
                                          const MapConfig& config) {
  const Vec3d work(0, 0, work_distance_mm);
  std::vector<std::size_t> out;
  for (std::size_t n = 0; n < bursts.size(); ++n) {
    const auto is_near = [&](std::size_t k) {
      return look_alike(bursts[k].T_model_cam, bursts[n].T_model_cam, work, {config.spacing_mm, config.spacing_deg});
    };
    if (!out.empty() && is_near(out.back())) continue;
    const auto crowd = std::ranges::count_if(out, is_near);
    if (crowd < config.crowd) out.push_back(n);
  }
  return out;
}

std::vector<KeyframePair> choose_pairs(const std::vector<MapBurst>& bursts, const std::vector<std::size_t>& keyframes,
                                       double work_distance_mm, const MapConfig& config) {
  std::vector<Gaze> gazes;
  gazes.reserve(keyframes.size());
  for (const std::size_t k : keyframes) {
    const Pose& T = bursts[k].T_model_cam;
    gazes.push_back({T * Vec3d(0, 0, work_distance_mm), T.linear().col(2)});
  }
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
