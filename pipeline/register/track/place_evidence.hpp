// What speaks for a place that a patch is said to lie at: all keyframes near it are asked together, for none of them
// need show much of what another side shows. Two judges: an alignment to what the keyframes show from there, and free
// space: no camera saw through a surface, neither the patch's through theirs nor theirs through the patch's.
#pragma once

#include <cstddef>
#include <vector>

#include "calib/model/rig.hpp"
#include "pipeline/register/icp/icp.hpp"
#include "pipeline/register/track/keyframes.hpp"

namespace enamel::pipeline {

struct EvidenceConfig {
  std::size_t max_keyframes = 8;  ///< chosen: 2 mm or 3 degrees apart, eight span more than a picture
  double draw_pitch_mm = 0.113;   ///< derived: of drawn pictures; keyframes keep half of it and may be stretched by
                                  ///< 1/cos 60 degrees
  double layer_mm = 0.3;          ///< chosen: surface nearer than this to another is the same, seen twice
  double match_mm = 0.15;         ///< as the finest gate of the alignment
  double match_deg = 30;
  double block_mm = 0.9;  ///< chosen: blocks of so much surface are averaged: 64 drawn pixels, an eighth of their noise
  double through_mm = 0.3;   ///< chosen: twice match_mm; a surface so far before another was seen through
  double min_area_mm2 = 50;  ///< chosen: a molar's table, a fifth of a picture; 36 mm² of one jaw have been seen to fit
                             ///< another's by chance
  double min_consistency = 0.90;  ///< chosen: at a true place only silhouettes disagree, a hundredth; another tooth of
                                  ///< the same kind has a tenth to a third
  double max_form_mm =
      0.020;  ///< chosen: calibration and motion leave 8 µm (plaster) to 15 µm (translucent teeth), another
              ///< tooth of the same kind 40 µm; noise of blocks a quarter full is added in squares
};

struct PlaceEvidence {
  double overlap = 0;      ///< share of the patch that meets any keyframe's surface
  double consistency = 0;  ///< what meets / (what meets + what was seen through, either way)
  double form_rms_mm = 0;  ///< of the mean distances of whole blocks: noise falls out, another tooth's form does not
  double area_mm2 = 0;     ///< of what meets, as the camera sees it
};

/// Indices of the keyframes that look at `point` (model frame) most nearly, nearest first.
[[nodiscard]] std::vector<std::size_t> keyframes_near(const std::vector<Keyframe>& keyframes, const Vec3d& point,
                                                      double work_distance_mm, std::size_t most);

struct DrawnFrom {
  Pose T_model_cam;
  int stride;  ///< camera pixels a drawn pixel; at least that of the keyframes
};

/// The keyframes' surface as it would look from there: nearest surface of each pixel, the first keyframe's where
/// several agree.
[[nodiscard]] ModelView draw_keyframes(const std::vector<Keyframe>& keyframes, const std::vector<std::size_t>& chosen,
                                       const DrawnFrom& from, const ViewCamera& camera, const EvidenceConfig& config);

/// `patch`: the patch as a view in its own camera's frame (T = identity), thinned. T_model_cam: where it may lie.
[[nodiscard]] PlaceEvidence weigh_place(const ModelView& patch, const Pose& T_model_cam,
                                        const std::vector<Keyframe>& keyframes, const std::vector<std::size_t>& chosen,
                                        const ViewCamera& camera, const EvidenceConfig& config);

/// Enough meets, and neither free space nor form speaks against it.
[[nodiscard]] bool convincing(const PlaceEvidence& evidence, double median_sigma_mm, const EvidenceConfig& config);

}  // namespace enamel::pipeline
