// Projective point-to-plane ICP of one patch against the model as seen from a nearby pose.
// Rusinkiewicz & Levoy 2001 (projective association, coarse to fine); degeneracy as in Zhang, Kaess & Singh 2016.
#pragma once

#include <array>
#include <cstddef>

#include "pipeline/register/icp/normal_system.hpp"
#include "pipeline/register/icp/patch_samples.hpp"
#include "pipeline/register/icp/reference.hpp"
#include "pipeline/register/icp/view_camera.hpp"

namespace enamel::pipeline {

struct IcpLevel {
  int stride_px = 2;
  double gate_mm = 0.15;       ///< larger point-to-plane distances are no match
  double max_normal_deg = 30;  ///< nor are normals that differ by more
  int max_iterations = 6;
};

struct IcpConfig {
  std::array<IcpLevel, 3> levels{IcpLevel{8, 1.0, 45, 10}, IcpLevel{4, 0.4, 35, 8}, IcpLevel{2, 0.15, 30, 6}};
  SampleConfig samples;
  ReferenceConfig reference;
  PriorConfig prior;
  double rho_mm = 4.5;       ///< lever that makes rotations comparable with translations
  double rms_change = 1e-3;  ///< a level ends when the residual changes by less (relative) and the step is small …
  double small_step_mm = 0.003;        ///< … below this,
  double end_translation_mm = 0.0005;  ///< or when the step is below both of these
  double end_rotation_rad = 1e-5;
  double huber_scale = 1.345;   ///< in robust standard deviations, levels 0 and 1
  double welsch_scale = 2.985;  ///< level 2
  double hidden_mm = 0.5;       ///< a turned camera sees surface that lay hidden behind the reference by this and more
  std::size_t min_matches = 200;  ///< at the level's stride; fewer end the alignment unconverged
};

/// The three levels of samples of one patch: made once, aligned as often as needed.
struct PatchPyramid {
  std::array<SampleSet, 3> levels;
};

struct IcpResult {
  bool converged = false;  ///< enough matches on every level; says nothing of their quality
  Pose T_model_cam = Pose::Identity();
  double rms_mm = 0;        ///< weighted, of the matches at the finest level
  double overlap = 0;       ///< matches / samples, finest level
  double consistency = 0;   ///< matches / (matches + samples that met the view but contradict it)
  int iterations = 0;       ///< over all levels
  int weak_directions = 0;  ///< held by the prior in the last step
  Vector6 eigenvalues = Vector6::Zero();
  NormalSystem system;         ///< of the last step, about T_model_cam * the finest samples' centroid
  int undetermined = 0;        ///< weak directions that texture does not hold either: there the prior stands alone
  bool texture_moved = false;  ///< texture holds, and it is the surface's own: TextureHold::moved
};

[[nodiscard]] PatchPyramid make_pyramid(const SurfacePatch& patch, const IcpConfig& config);
/// The same into one whose memory is used again.
void make_pyramid(const SurfacePatch& patch, const IcpConfig& config, PatchPyramid& out);

/// Aligns the patch, starting at `start`; `prior` is where motion says it is and holds directions that the surface
/// leaves free. Pure: the same arguments give the same bits. Thread-safe. Never fails: see IcpResult::converged.
[[nodiscard]] IcpResult align(const PatchPyramid& patch, const Reference& reference, const ViewCamera& camera,
                              const Pose& start, const Pose& prior, const IcpConfig& config);

}  // namespace enamel::pipeline
