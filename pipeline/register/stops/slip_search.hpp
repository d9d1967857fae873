// A stop that does not lie where the axes put it, looked for around there.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calib/model/rig.hpp"
#include "pipeline/register/icp/icp.hpp"
#include "pipeline/register/icp/layered_icp.hpp"
#include "pipeline/register/stops/mount_prior.hpp"
#include "pipeline/register/stops/stop.hpp"

namespace enamel::pipeline {

/// How stops are laid on each other. Refers to its parts.
struct LayingRules {
  const calib::LensValues& lens;
  const IcpConfig& icp;
  const EdgeConfig& edge;
};

struct SlipConfig {
  StopSigma stop;
  double min_overlap = 0.25;  ///< foretold, of the stops that one is tried on …
  std::size_t tried_on = 4;   ///< … most first
  double gate_mm = 1.5;       ///< of the foretelling: a slipped stop overlaps what it is compared with all the same
  double sigmas = 6;          ///< derived: of all six directions together; by chance one stop of 300 000 is farther off
  double edge_sigma_mm = 0.004;  ///< chosen: of one edge's shift at its own centre, turns by their lever
  double search_deg = 6;         ///< chosen: of either axis; a lost step of a direct drive is 1.8 degrees …
  double search_step_deg = 2;    ///< … and laying mends half of this and more: 1 degree at the arch is 0.6 mm
  double search_mm = 2;          ///< chosen: of a model that slid on the table …
  double search_step_mm = 2;     ///< … of which laying mends half and more
  LayeredConfig layered;         ///< by which it is laid from there
  double agree_mm = 0.05;        ///< two stops tell of the same slip: at what is seen
  double min_consistency = 0.85;
};

/// Poses about `T` at which a slipped stop may lie: either axis further or less far, the model slid along the table.
/// Nearest first within each kind. `centre`: of what it sees, model frame.
[[nodiscard]] std::vector<Pose> starts_about(const Pose& T, const Vec3d& centre, const AxisMotions& motions,
                                             double rho_mm, const SlipConfig& config);

/// T_model_cam of stop i, laid on stop j that stands at `T_model_j`, from the start that fits best; none that fits:
/// nullopt.
[[nodiscard]] std::optional<Pose> lay_from_afar(const Stop& i, const Stop& j, const Pose& T_model_j,
                                                const std::vector<Pose>& starts, const LayingRules& with,
                                                const SlipConfig& config);

}  // namespace enamel::pipeline
