// ICP by the mixed metric in layers that each have a stop of their own: how two scans of a desktop mount, laid together
// by the calibrated axes, are laid together finely. The metric: mixed_metric.hpp.
//
// Layered stop: a layer ends when the residual hardly changes (relative) and the step is small, when the step is below
// two finer bounds, or after its number of iterations. The last layer is point to plane alone, for the point term slows
// what it steadies, and biases.
#pragma once

#include <array>
#include <cstddef>

#include "pipeline/register/icp/icp.hpp"
#include "pipeline/register/icp/mixed_metric.hpp"

namespace enamel::pipeline {

struct MixedLayer {
  int stride_px = 2;
  double gate_mm = 0.15;       ///< larger distances, to the plane and to the closest point, are no match
  double max_normal_deg = 30;  ///< nor are normals that differ by more
  double lambda = 1;           ///< share of the plane term, 0 … 1
  int max_iterations = 6;
};

struct LayeredConfig {
  std::array<MixedLayer, 3> layers{MixedLayer{8, 2.0, 45, 0.3, 30}, MixedLayer{4, 0.4, 35, 0.7, 20},
                                   MixedLayer{2, 0.15, 30, 1, 20}};
  SampleConfig samples = {};
  MatchConfig match = {};
  /// The start is the prior: what the surface leaves free stays where the axes put it. A tenth of the tracker's bounds:
  /// a model at rest has no ripple of motion, and 10 um over 10 000 matches is 3 um along a direction of this
  /// eigenvalue; more would hold a smooth molar 10 um from where its shape has it.
  PriorConfig prior{0.001, 0.0005};
  double rho_mm = 4.5;               ///< as IcpConfig
  double rms_change = 1e-3;          ///< layered stop: dRMS / RMS below this …
  double small_step_mm = 0.003;      ///< … once steps are below this,
  double end_translation_mm = 5e-4;  ///< or steps below this
  double end_rotation_rad = 1e-5;    ///< … and this
  double huber_scale = 1.345;        ///< in robust standard deviations, all layers but the last
  double welsch_scale = 2.985;       ///< the last
  double hidden_mm = 0.5;            ///< as IcpConfig
  std::size_t min_matches = 200;     ///< as IcpConfig
};

/// The layers of the dissertation: 10, 8 and 6 iterations, a first gate of 1 mm, and a residual that hardly changes
/// ends a layer whatever its steps. The point term makes small steps, which this takes for the end more often.
[[nodiscard]] LayeredConfig published_layers();

/// The same layers with all lambdas 1: plain point to plane.
[[nodiscard]] LayeredConfig plain_point_to_plane(LayeredConfig config);

[[nodiscard]] PatchPyramid make_pyramid(const SurfacePatch& patch, const LayeredConfig& config);

/// Aligns the patch, starting at `start`. Pure: the same arguments give the same bits. Thread-safe. Never fails: see
/// IcpResult::converged, which says here, too, that there were enough matches in every layer.
[[nodiscard]] IcpResult align_layered(const PatchPyramid& patch, const Reference& reference, const ViewCamera& camera,
                                      const Pose& start, const LayeredConfig& config);

}  // namespace enamel::pipeline
