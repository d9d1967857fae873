// Light and fringes over squares of the image, by which the sight is judged. Private to pipeline/decode.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "pipeline/decode/phase/noise_model.hpp"
#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/steps/chosen.hpp"

namespace enamel::pipeline {

/// Sums over the pixels that are not saturated.
struct SightCell {
  int measured = 0, saturated = 0;
  double light = 0, fringe2 = 0, noise2 = 0;  ///< A above black, B^2, and what noise adds to B^2

  [[nodiscard]] double light_dn() const noexcept { return measured > 0 ? light / measured : 0; }
  [[nodiscard]] double fringe_dn() const noexcept {
    return measured > 0 && fringe2 > noise2 ? std::sqrt((fringe2 - noise2) / measured) : 0;
  }
  [[nodiscard]] double contrast() const noexcept { return is_lit() ? fringe_dn() / light_dn() : 0; }
  /// Bright enough for its contrast to mean anything.
  [[nodiscard]] bool is_lit() const noexcept {
    return measured > 0 && light * light > kLitSigmas * kLitSigmas * noise2 * measured;
  }
};

struct SightCells {
  int columns = 0, rows = 0;
  std::vector<SightCell> all;
  std::size_t lit_px = 0, saturated_px = 0;
  double cosine = 0, sine = 0, light = 0;  ///< sums over lit pixels

  /// By how much the frames' means differ, over the mean light: whole fringes average out.
  [[nodiscard]] double unevenness() const noexcept { return light > 0 ? std::hypot(cosine, sine) / light : 0; }
};

[[nodiscard]] SightCells sight_cells(const PhaseMaps& maps, const NoiseModel& noise);

/// Cells that adjoin each other, and the middle of them.
struct CellGroup {
  std::size_t cells = 0;
  double x_px = 0, y_px = 0;
};

/// The largest group of cells that `belongs` tells, diagonal neighbours included.
[[nodiscard]] CellGroup largest_group(const SightCells& cells, const std::function<bool(const SightCell&)>& belongs);

}  // namespace enamel::pipeline
