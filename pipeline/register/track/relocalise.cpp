#include "pipeline/register/track/relocalise.hpp"

#include <algorithm>
#include <numbers>

namespace enamel::pipeline {
namespace {

struct Hypothesis {
  std::size_t keyframe = 0;
  RigidFit fit;
};

std::vector<Hypothesis> hypotheses(const LostPatch& patch, const KnownPlaces& places, double ratio,
                                   const RansacConfig& config) {
  const std::vector<Feature>& features = patch.features;
  std::vector<Hypothesis> out;
  for (const std::size_t k : places.candidates) {
    const Keyframe& frame = places.keyframes[k];
    std::vector<PointPair> pairs;
    for (const FeatureMatch& match : match_features(features, frame.features, ratio)) {
      pairs.push_back(
          {features[match.a].point.cast<double>(), frame.T_model_cam * frame.features[match.b].point.cast<double>()});
    }
    if (const auto fit = fit_rigid(pairs, patch.seed + k, config)) out.push_back({k, *fit});
  }
  std::sort(out.begin(), out.end(), [](const Hypothesis& a, const Hypothesis& b) {
    return a.fit.inliers != b.fit.inliers ? a.fit.inliers > b.fit.inliers : a.keyframe < b.keyframe;
  });
  return out;
}

bool other_place(const Pose& a, const Pose& b, const RelocaliseConfig& config) {
  const Vec3d work(0, 0, config.work_distance_mm);
  const Eigen::AngleAxisd turn(a.linear().transpose() * b.linear());
  return (a * work - b * work).norm() > config.rival_mm || turn.angle() > config.rival_deg * std::numbers::pi / 180;
}

}  // namespace

std::optional<Relocalised> relocalise(const LostPatch& patch, const KnownPlaces& places, const ViewCamera& camera,
                                      double ratio, const IcpConfig& icp, const RelocaliseConfig& config) {
  const auto found = hypotheses(patch, places, ratio, config.ransac);
  const std::size_t limit = std::min(found.size(), static_cast<std::size_t>(config.max_verified));
  for (std::size_t i = 0; i < limit; ++i) {
    const Hypothesis& h = found[i];
    const Reference reference(places.keyframes[h.keyframe].view, icp.reference);
    const IcpResult result = align(patch.pyramid, reference, camera, h.fit.T_to_from, h.fit.T_to_from, icp);
    if (!acceptable(result, patch.pyramid.levels.back().median_sigma_mm, config.accept)) continue;
    const bool rival = std::any_of(found.begin(), found.end(), [&](const Hypothesis& other) {
      return other.fit.inliers >= config.rival_ratio * h.fit.inliers &&
             other_place(other.fit.T_to_from, result.T_model_cam, config);
    });
    if (rival) return std::nullopt;
    return Relocalised{result, h.keyframe, h.fit.inliers};
  }
  return std::nullopt;
}

}  // namespace enamel::pipeline
