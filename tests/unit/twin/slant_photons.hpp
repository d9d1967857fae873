// Photons on a surface at a slant: contrast and shift of fringes by the directions of light and view.
#pragma once

#include <vector>

#include "tests/unit/twin/slab_photons.hpp"

namespace enamel::twin::testing {

struct SlantResponse {
  double modulation = 0;
  double shift_mm = 0;  // along x, from where the light seen leaves to where it entered, on average
};

/// Fringes across x under one light, at all views and periods (mm, on the surface) by the same photons: view by view,
/// of each all periods. Directions are those outside, away from the surface.
inline std::vector<std::vector<SlantResponse>> slant_responses(PhotonWalk walk, PhotonWalk::Slant light,
                                                               const std::vector<double>& periods_mm,
                                                               const std::vector<PhotonWalk::Slant>& views,
                                                               int photons) {
  std::vector<std::vector<std::complex<double>>> sums(views.size(),
                                                      std::vector<std::complex<double>>(periods_mm.size()));
  std::vector<double> totals(views.size());
  const auto at = [&](const PhotonWalk::Way& w, double weight) {
    for (std::size_t v = 0; v < views.size(); ++v) {
      const auto seen = walk.peel(w, weight, views[v]);
      totals[v] += seen.leaves;
      for (std::size_t p = 0; p < periods_mm.size(); ++p) {
        sums[v][p] += seen.leaves * std::polar(1.0, 2 * std::numbers::pi * seen.x / periods_mm[p]);
      }
    }
  };
  // Along the very normal a scattering could not turn about it.
  for (int i = 0; i < photons; ++i) walk.follow({-light.x - 1e-3, -light.y}, at);
  std::vector<std::vector<SlantResponse>> out(views.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    for (std::size_t p = 0; p < periods_mm.size(); ++p) {
      out[v].push_back(
          {std::abs(sums[v][p]) / totals[v], -std::arg(sums[v][p]) * periods_mm[p] / (2 * std::numbers::pi)});
    }
  }
  return out;
}

}  // namespace enamel::twin::testing
