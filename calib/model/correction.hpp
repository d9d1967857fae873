// The smooth part of the measurement that no lens formula explains: a correction of 1/z over the measuring volume
// (docs/calibration.md §6). Pure functions, thread-safe.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace enamel::calib {

/// delta(1/z)(u, v, Phi) = sum c_ijk T_i(U) T_j(V) T_k(W) with Chebyshev polynomials T; U and V are the camera pixel
/// mapped linearly from `u_px`, `v_px` onto [-1, 1]. W is the phase Phi expressed by the 1/z that the parametric model
/// gives it on the pixel's ray (one to one, and the same for every fringe period), mapped from `inverse_mm`.
/// Corrected: 1/z = 1/z_parametric + delta. Outside the intervals the field continues with its border values.
struct CorrectionField {
  std::array<double, 2> u_px{}, v_px{}, inverse_mm{};  ///< low, high of each axis
  std::array<int, 3> terms{};                          ///< along u, v, Phi; at most kMaxCorrectionTerms
  std::vector<double> coefficients;  ///< 1/mm, terms[0] * terms[1] * terms[2], the last index runs fastest
};

/// Degrees 0…4 along u and v, 0…3 along Phi.
inline constexpr std::array<int, 3> kMaxCorrectionTerms{5, 5, 4};

/// The products T_i T_j T_k at a place, in the order of `coefficients`. `basis` is resized.
void correction_basis(const CorrectionField& field, double u_px, double v_px, double inverse_mm,
                      std::vector<double>& basis);

/// delta at a place, 1/mm.
[[nodiscard]] double correction_at(const CorrectionField& field, double u_px, double v_px, double inverse_mm);

/// The parametric 1/z whose corrected value is `inverse_mm`: where the projector is asked for its coordinate of a point
/// at a known depth. Fixed point; delta changes by far less than its argument.
[[nodiscard]] double parametric_inverse(const CorrectionField& field, double u_px, double v_px, double inverse_mm);

}  // namespace enamel::calib
