// Finds the dots of a circle grid in an image and tells which dot is which.
#pragma once

#include <vector>

#include "calib/target/disc_fit.hpp"
#include "calib/target/target.hpp"

namespace enamel::calib {

/// A dot of the target and the ellipse of its blob (threshold moments, good to some tenths of a pixel).
struct GridDot {
  int index = 0;  ///< TargetDesign::index
  Ellipse blob;
};

struct DotGrid {
  std::vector<GridDot> dots;  ///< by rising index; missing dots are absent
  double spacing_px = 0;      ///< smallest distance of two dots
};

/// `image`: white minus black, DN. The columns run to the right within 90 degrees, or as the rings of `marks` say; rows
/// so that z faces the camera; a coded board's dots say which they are. Single dots may be missing; an outer row or
/// column may not be missing altogether. Errors: kTargetNotFound (what was seen, what target.json says, what to do);
/// kTargetAmbiguous when two targets are in view.
[[nodiscard]] Result<DotGrid> find_dot_grid(const Map<float>& image, const TargetDesign& target);

}  // namespace enamel::calib
