#include "pipeline/register/track/find_turned.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/register/icp/patch_view.hpp"
#include "pipeline/types/pixel_step.hpp"

namespace enamel::pipeline {
namespace {

/// Fits as closely as acceptance asks, wherever it meets: cheaper to tell than evidence, and most wrong places fail it.
bool close_fit(const IcpResult& icp, double median_sigma_mm, const AcceptConfig& config) {
  IcpResult judged = icp;
  judged.overlap = 1;
  judged.consistency = 1;
  return acceptable(judged, median_sigma_mm, config);
}

/// Overlap and consistency are those of all keyframes near, not of the one view that was aligned to.
bool believable(const TriedPlace& place, double median_sigma_mm, const RelocaliseConfig& config) {
  IcpResult judged = place.icp;
  judged.overlap = place.evidence.overlap;
  judged.consistency = place.evidence.consistency;
  return place.icp.weak_directions == 0 && acceptable(judged, median_sigma_mm, config.accept_turned) &&
         convincing(place.evidence, median_sigma_mm, config.evidence);
}

/// Camera pixels a drawn pixel.
int draw_stride(const calib::LensValues& lens, const RelocaliseConfig& config) {
  return pixel_step(config.evidence.draw_pitch_mm, lens.fx / config.work_distance_mm);
}

/// The alignment without its finest level, which costs three quarters of it: enough to tell a wrong place.
PatchPyramid without_finest(const PatchPyramid& patch) { return {{patch.levels[0], patch.levels[1], patch.levels[1]}}; }

/// What is laid on what. Refers to its parts.
struct Trial {
  const PatchPyramid& pyramid;
  const PatchPyramid& coarse;
  const ModelView& own;  ///< the patch as a view in its own frame
  const std::vector<Keyframe>& frames;
  const ViewCamera& camera;
};

TriedPlace try_place(const PlaceHypothesis& hypothesis, const Trial& of, const IcpConfig& icp,
                     const RelocaliseConfig& config) {
  const auto& [pyramid, coarse, own, frames, camera] = of;
  const Vec3d centre = hypothesis.T_model_cam * pyramid.levels.back().centroid;
  const auto near = keyframes_near(frames, centre, config.work_distance_mm, config.evidence.max_keyframes);
  const ModelView drawn = draw_keyframes(frames, near, {hypothesis.T_model_cam, own.stride}, camera, config.evidence);
  const Reference reference(drawn, icp.reference);
  TriedPlace out;
  out.support = hypothesis.support;
  out.keyframe = near.front();
  const Pose& start = hypothesis.T_model_cam;
  out.icp = align(coarse, reference, camera, start, start, icp);
  const double sigma = pyramid.levels.back().median_sigma_mm;
  if (!close_fit(out.icp, sigma, config.accept_turned)) return out;
  out.evidence = weigh_place(own, out.icp.T_model_cam, frames, near, camera, config.evidence);
  if (!believable(out, sigma, config)) return out;
  const Pose found = out.icp.T_model_cam;
  out.icp = align(pyramid, reference, camera, found, found, icp);
  return out;
}

}  // namespace

std::vector<TriedPlace> try_places(const LostPatch& lost, const KnownPlaces& places, const calib::LensValues& lens,
                                   const IcpConfig& icp, const RelocaliseConfig& config) {
  const KeyframeConfig& kept = places.keyframes.config();
  const auto asked = places.keyframes.candidates(places.T_model_cam, places.turn, kept.max_voting);
  places.keyframes.describe_surface(asked);
  const std::vector<Keyframe>& frames = places.keyframes.all();
  std::vector<KnownFeatures> known;
  for (const std::size_t k : asked) {
    known.push_back({frames[k].surface, frames[k].T_model_cam});
  }
  const auto features = extract_surface_features(lost.patch, lens.fx / config.work_distance_mm, kept.surface);
  const ViewCamera camera(lens);
  const ModelView own = view_from_patch(lost.patch, Pose::Identity(), lens, draw_stride(lens, config));
  const PatchPyramid coarse = without_finest(lost.pyramid);
  const Trial trial{lost.pyramid, coarse, own, frames, camera};
  std::vector<TriedPlace> out;
  for (const PlaceHypothesis& hypothesis : vote_for_places(features, known, config.votes)) {
    out.push_back(try_place(hypothesis, trial, icp, config));
  }
  return out;
}

PlaceEvidence weigh_found(const LostPatch& lost, const KnownPlaces& places, const Pose& T_model_cam,
                          const calib::LensValues& lens, const RelocaliseConfig& config) {
  const std::vector<Keyframe>& frames = places.keyframes.all();
  const Vec3d centre = T_model_cam * lost.pyramid.levels.back().centroid;
  const auto near = keyframes_near(frames, centre, config.work_distance_mm, config.evidence.max_keyframes);
  const ModelView own = view_from_patch(lost.patch, Pose::Identity(), lens, draw_stride(lens, config));
  return weigh_place(own, T_model_cam, frames, near, ViewCamera(lens), config.evidence);
}

bool another_place(const Pose& a, const Pose& b, const RelocaliseConfig& config) {
  const Vec3d work(0, 0, config.work_distance_mm);
  const Eigen::AngleAxisd turn(a.linear().transpose() * b.linear());
  return (a * work - b * work).norm() > config.rival_mm || turn.angle() > config.rival_deg * std::numbers::pi / 180;
}

std::optional<Relocalised> choose_place(const std::vector<TriedPlace>& tried, double median_sigma_mm,
                                        const RelocaliseConfig& config) {
  const auto best = std::find_if(tried.begin(), tried.end(),
                                 [&](const TriedPlace& place) { return believable(place, median_sigma_mm, config); });
  if (best == tried.end()) return std::nullopt;
  const bool rival = std::any_of(tried.begin(), tried.end(), [&](const TriedPlace& other) {
    if (!another_place(other.icp.T_model_cam, best->icp.T_model_cam, config)) return false;
    // What could not be aligned is not refuted.
    return other.icp.converged ? believable(other, median_sigma_mm, config)
                               : other.support >= config.rival_ratio * best->support;
  });
  if (rival) return std::nullopt;
  return Relocalised{best->icp, best->keyframe, best->support};
}

}  // namespace enamel::pipeline
