#include "pipeline/register/track/acceptance.hpp"

#include <cmath>

namespace enamel::pipeline {

bool acceptable(const IcpResult& result, double median_sigma_mm, const AcceptConfig& config) {
  const double limit = std::hypot(config.max_rms_mm, config.sigma_factor * median_sigma_mm);
  return result.converged && result.overlap >= config.min_overlap && result.consistency >= config.min_consistency &&
         result.rms_mm <= limit;
}

}  // namespace enamel::pipeline
