// The pattern set of a drawn unit as it reaches a surface: levels, response, projector pixels, blur by depth.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "tests/support/draw/conditions.hpp"

namespace enamel::test {

class Emission {
 public:
  explicit Emission(const Drawn& drawn);

  /// Emission 0 … 1 of frame `frame` at projector column `column_px`, depth_mm before the projector.
  [[nodiscard]] double operator()(int frame, double column_px, double depth_mm) const {
    const double x = (column_px + kMargin_px) * kPerPixel;
    if (!(x > 0 && x < static_cast<double>(points_ - 1))) return 0;
    const double defocus = drawn_.optics.blur_px_per_mm * (depth_mm - drawn_.optics.focus_mm);
    const double s = std::min(defocus * defocus / step_px2_, kSigmas - 1.001);
    const auto i = static_cast<std::size_t>(x), k = static_cast<std::size_t>(s);
    const double dx = x - static_cast<double>(i), ds = s - static_cast<double>(k);
    const float* sharp = &table_[static_cast<std::size_t>(frame)][k * points_ + i];
    const float* soft = sharp + points_;
    const double a = static_cast<double>(sharp[0]), b = static_cast<double>(soft[0]);
    const double at_sharp = a + dx * (static_cast<double>(sharp[1]) - a);
    const double at_soft = b + dx * (static_cast<double>(soft[1]) - b);
    const double pattern = at_sharp + ds * (at_soft - at_sharp);
    return pattern + drawn_.paint.haze * (mean_[static_cast<std::size_t>(frame)] - pattern);
  }

 private:
  static constexpr int kPerPixel = 8, kMargin_px = 20, kSigmas = 10;  ///< tables: points a pixel, blurs

  void tabulate(std::size_t frame, std::size_t blur, double sigma_px);

  const Drawn& drawn_;
  std::size_t points_ = 0;
  double step_px2_ = 1;  ///< of the blur's variance from one table to the next
  std::array<std::vector<double>, 4> emitted_;
  std::array<double, 4> mean_{};
  std::array<std::vector<float>, 4> table_;
};

}  // namespace enamel::test
