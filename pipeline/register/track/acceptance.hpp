// When an alignment may be believed. One place, so that tracking and relocalisation cannot drift apart.
#pragma once

#include "pipeline/register/icp/icp.hpp"

namespace enamel::pipeline {

struct AcceptConfig {
  double min_overlap = 0.30;      ///< share of the patch that met the reference
  double min_consistency = 0.75;  ///< of what fell on the reference, the share that agrees with it
  double max_rms_mm = 0.040;      ///< what geometry and motion may leave …
  double sigma_factor = 1.5;  ///< … plus, in squares, this many times the patch's own median sigma (bare teeth: 40 µm)
};

[[nodiscard]] bool acceptable(const IcpResult& result, double median_sigma_mm, const AcceptConfig& config);

}  // namespace enamel::pipeline
