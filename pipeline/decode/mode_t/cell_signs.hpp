// The polarity of every half fringe of the projector: the pattern set as data.
#pragma once

#include <vector>

#include "calib/model/rig.hpp"

namespace enamel::pipeline {

/// Cell c covers phase [c*pi, (c+1)*pi), counted from projector pixel 0.
struct CellSigns {
  std::vector<float> sign;   ///< +1 / -1 for cells 0 … size-1 of the projector's frame
  bool informative = false;  ///< both signs occur: frame 3 tells fringes apart
  int repeats_after = 0;     ///< fringes; 1 without a code, 0: never within the frame

  [[nodiscard]] int cells() const noexcept { return static_cast<int>(sign.size()); }
  /// Outside the frame: the nearest cell's sign.
  [[nodiscard]] float at(int cell) const noexcept {
    const int last = cells() - 1;
    return sign[static_cast<std::size_t>(cell < 0 ? 0 : (cell > last ? last : cell))];
  }
};

/// Errors: kPatternSet for modes that have no four-step solution (M, multi) and for fringes along v.
[[nodiscard]] Result<CellSigns> make_cell_signs(const calib::PatternValues& patterns,
                                                const calib::LensValues& projector);

/// Whether the code tells apart the fringe orders that a depth range of span_fringes leaves open at one pixel. Error:
/// kPatternAmbiguous when three half fringes or more look the same at two of them; the message names the longest such
/// window.
[[nodiscard]] Result<void> check_windows_differ(const CellSigns& signs, double span_fringes);

}  // namespace enamel::pipeline
