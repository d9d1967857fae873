// Which dots of a coded board are in view: the seen part of its lattice laid on the map.
#pragma once

#include "calib/target/dot_grid.hpp"

namespace enamel::calib {

/// A lattice place and what its dot's middle shows.
struct CodedDot {
  int a = 0, b = 0;  ///< right-handed: a x b as columns x rows of the design
  int bit = -1;      ///< 1 a ring, 0 a dot, -1 neither clearly
};

/// Column and row of a lattice place: col = c0 + ca a + cb b, row = r0 + ra a + rb b.
struct CodePlacement {
  int c0 = 0, ca = 1, cb = 0, r0 = 0, ra = 0, rb = 1;
  int read = 0, wrong = 0;  ///< clear bits; those that contradict the map or lie beyond it

  [[nodiscard]] GridIndex at(const CodedDot& d) const noexcept {
    return {c0 + ca * d.a + cb * d.b, r0 + ra * d.a + rb * d.b};
  }
};

/// The one placement, of all offsets and four turns, whose agreement with the map is not chance: random bits would
/// agree as well at any of the places with a probability below 1e-6, and the next best place contradicts at least four
/// bits more. A placement is never guessed. Errors: kTargetNotFound (too few dots, or another map), kTargetMirrored.
[[nodiscard]] Result<CodePlacement> place_on_map(const std::vector<CodedDot>& dots, const TargetDesign& target);

/// `image`: white minus black, DN. For targets of type kCodedDots; the board may be seen in part.
/// Errors: those of place_on_map; kTargetAmbiguous when a second lattice is in view.
[[nodiscard]] Result<DotGrid> find_coded_grid(const Map<float>& image, const TargetDesign& target);

/// Paints over the hole of a ring with the ring's own light (a plane fitted to its middle), so that fit_disc sees a
/// disc with the ring's outer contour. `inner_share`: radius of the hole over that of the ring.
void fill_ring(Map<float>& image, const Ellipse& ring, double inner_share);

}  // namespace enamel::calib
