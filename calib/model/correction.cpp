#include "calib/model/correction.hpp"

#include <algorithm>

namespace enamel::calib {
namespace {

constexpr int kFixedPointSteps = 4;
constexpr std::size_t kMostTerms = 5;

using Polynomials = std::array<double, kMostTerms>;

/// T_0…T_4 at the place of `value` in the interval, held at its ends.
Polynomials chebyshev(const std::array<double, 2>& interval, double value) {
  const double x = std::clamp((2 * value - interval[0] - interval[1]) / (interval[1] - interval[0]), -1.0, 1.0);
  Polynomials t{1, x};
  for (std::size_t n = 2; n < kMostTerms; ++n) t[n] = 2 * x * t[n - 1] - t[n - 2];
  return t;
}

template <class Use>
void for_each_product(const CorrectionField& f, double u_px, double v_px, double inverse_mm, const Use& use) {
  const Polynomials u = chebyshev(f.u_px, u_px), v = chebyshev(f.v_px, v_px), w = chebyshev(f.inverse_mm, inverse_mm);
  const auto count = [&](std::size_t axis) { return static_cast<std::size_t>(f.terms[axis]); };
  for (std::size_t i = 0; i < count(0); ++i) {
    for (std::size_t j = 0; j < count(1); ++j)
      for (std::size_t k = 0; k < count(2); ++k) use(u[i] * v[j] * w[k]);
  }
}

}  // namespace

void correction_basis(const CorrectionField& field, double u_px, double v_px, double inverse_mm,
                      std::vector<double>& basis) {
  basis.clear();
  for_each_product(field, u_px, v_px, inverse_mm, [&](double product) { basis.push_back(product); });
}

double correction_at(const CorrectionField& field, double u_px, double v_px, double inverse_mm) {
  double sum = 0;
  std::size_t at = 0;
  for_each_product(field, u_px, v_px, inverse_mm, [&](double product) { sum += field.coefficients[at++] * product; });
  return sum;
}

double parametric_inverse(const CorrectionField& field, double u_px, double v_px, double inverse_mm) {
  double q = inverse_mm;
  for (int i = 0; i < kFixedPointSteps; ++i) q = inverse_mm - correction_at(field, u_px, v_px, q);
  return q;
}

}  // namespace enamel::calib
