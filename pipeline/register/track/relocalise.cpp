#include "pipeline/register/track/relocalise.hpp"

#include <algorithm>
#include <utility>

#include "pipeline/register/track/find_turned.hpp"

namespace enamel::pipeline {
namespace {

struct Hypothesis {
  std::size_t keyframe = 0;
  RigidFit fit;
};

std::vector<Hypothesis> hypotheses(const LostPatch& lost, const KnownPlaces& places, double px_per_mm,
                                   const RelocaliseConfig& config) {
  const auto features = extract_features(lost.patch, px_per_mm, config.features);
  KeyframeStore& store = places.keyframes;
  const auto asked = store.candidates(places.T_model_cam, places.turn, store.config().max_tried);
  store.describe(asked, store.config().max_described);
  std::vector<Hypothesis> out;
  for (const std::size_t k : asked) {
    const Keyframe& frame = store.all()[k];
    if (!frame.features) continue;
    const std::vector<Feature>& known = *frame.features;
    std::vector<PointPair> pairs;
    for (const FeatureMatch& match : match_features(features, known, config.features.ratio)) {
      pairs.push_back(
          {features[match.a].point.cast<double>(), frame.T_model_cam * known[match.b].point.cast<double>()});
    }
    if (const auto fit = fit_rigid(pairs, lost.seed + k, config.ransac)) out.push_back({k, *fit});
  }
  std::sort(out.begin(), out.end(), [](const Hypothesis& a, const Hypothesis& b) {
    return a.fit.inliers != b.fit.inliers ? a.fit.inliers > b.fit.inliers : a.keyframe < b.keyframe;
  });
  return out;
}

std::optional<Relocalised> find_by_pictures(const LostPatch& lost, const KnownPlaces& places,
                                            const calib::LensValues& lens, const IcpConfig& icp,
                                            const RelocaliseConfig& config) {
  const auto found = hypotheses(lost, places, lens.fx / config.work_distance_mm, config);
  const std::size_t limit = std::min(found.size(), static_cast<std::size_t>(config.max_verified));
  for (std::size_t i = 0; i < limit; ++i) {
    const Hypothesis& h = found[i];
    const Reference reference(places.keyframes.all()[h.keyframe].view, icp.reference);
    const IcpResult result = align(lost.pyramid, reference, ViewCamera(lens), h.fit.T_to_from, h.fit.T_to_from, icp);
    const double sigma = lost.pyramid.levels.back().median_sigma_mm;
    if (!acceptable(result, sigma, config.accept)) continue;
    if (!convincing(weigh_found(lost, places, result.T_model_cam, lens, config), sigma, config.evidence)) continue;
    const bool rival = std::any_of(found.begin(), found.end(), [&](const Hypothesis& other) {
      return other.fit.inliers >= config.rival_ratio * h.fit.inliers &&
             another_place(other.fit.T_to_from, result.T_model_cam, config);
    });
    if (rival) return std::nullopt;
    return Relocalised{result, h.keyframe, h.fit.inliers};
  }
  return std::nullopt;
}

}  // namespace

std::optional<Relocalised> relocalise(const LostPatch& lost, const KnownPlaces& places, const calib::LensValues& lens,
                                      const IcpConfig& icp, const RelocaliseConfig& config) {
  const auto tried = try_places(lost, places, lens, icp, config);
  if (auto found = choose_place(tried, lost.pyramid.levels.back().median_sigma_mm, config)) return found;
  return find_by_pictures(lost, places, lens, icp, config);
}

}  // namespace enamel::pipeline
