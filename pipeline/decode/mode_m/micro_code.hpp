// Mode M as data: three 120-degree frames and one code frame of slightly higher frequency (docs/decode.md §2; the idea
// of micro phase shifting: Gupta & Nayar 2012). With Phi = phi + 2 pi k, phi in [-pi, pi), and L = code_ratio:
//   code frame = A + B cos(Phi (1 + 1/L)) = A + B cos(phi + phi/L + 2 pi k/L)
// so that order k turns the code by k steps of 2 pi/L, the same for every pixel.
#pragma once

#include <cstdint>
#include <vector>

#include "calib/model/rig.hpp"

namespace enamel::pipeline {

struct MicroCode {
  float inverse_ratio = 0;          ///< 1/L
  int cells = 0;                    ///< half fringes of the projector's frame, as CellSigns counts them
  int repeats_after = 0;            ///< orders: L, or its numerator; 0: never within the frame
  std::vector<float> cosine, sine;  ///< of 2 pi k/L for the orders k = 0 … of the frame

  [[nodiscard]] double ratio() const noexcept { return 1.0 / static_cast<double>(inverse_ratio); }
};

/// Errors: kPatternSet when the mode is not M, for fringes along v, and for a code_ratio below 2.
[[nodiscard]] Result<MicroCode> make_micro_code(const calib::PatternValues& patterns,
                                                const calib::LensValues& projector);

/// Whether the code tells all orders apart that a pixel's depth range leaves open: span_fringes is the largest such
/// range, which holds K = floor(span) + 1 orders. Error: kPatternAmbiguous when L < K (orders k and k + L look alike)
/// and when two of the K orders turn the code by nearly the same angle.
[[nodiscard]] Result<void> check_orders_differ(double code_ratio, double span_fringes);

}  // namespace enamel::pipeline
