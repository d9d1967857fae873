// A phase error split into the part that repeats with the phase and the rest.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace enamel::test {

struct FoldedError {
  double mean_rad = 0;       ///< a constant phase: no frame of the burst shows it, and it bends no surface
  double rms_rad = 0;        ///< about that mean
  double repeating_rad = 0;  ///< rms of the means of 64 bins of phase, about the mean
  std::size_t pixels = 0;
};

class ErrorFolder {
 public:
  void add(double error_rad, double phase_rad) {
    const double turns = phase_rad / (2 * std::numbers::pi);
    const auto bin = static_cast<std::size_t>((turns - std::floor(turns)) * kBins) % kBins;
    sums_[bin] += error_rad;
    counts_[bin] += 1;
    squares_ += error_rad * error_rad;
  }

  [[nodiscard]] FoldedError result() const {
    double n = 0, sum = 0;
    for (std::size_t b = 0; b < kBins; ++b) n += counts_[b], sum += sums_[b];
    FoldedError out;
    if (n <= 0) return out;
    out.pixels = static_cast<std::size_t>(n);
    out.mean_rad = sum / n;
    out.rms_rad = std::sqrt(std::max(0.0, squares_ / n - out.mean_rad * out.mean_rad));
    double repeating = 0;
    for (std::size_t b = 0; b < kBins; ++b)
      if (counts_[b] > 0) repeating += counts_[b] * std::pow(sums_[b] / counts_[b] - out.mean_rad, 2);
    out.repeating_rad = std::sqrt(repeating / n);
    return out;
  }

  /// Mean error per bin, rad; for curves.
  [[nodiscard]] std::vector<double> curve() const {
    std::vector<double> means;
    for (std::size_t b = 0; b < kBins; ++b) means.push_back(counts_[b] > 0 ? sums_[b] / counts_[b] : 0);
    return means;
  }

 private:
  static constexpr std::size_t kBins = 64;
  std::array<double, kBins> sums_{}, counts_{};
  double squares_ = 0;
};

inline double wrap_pi(double a) { return std::remainder(a, 2 * std::numbers::pi); }

}  // namespace enamel::test
