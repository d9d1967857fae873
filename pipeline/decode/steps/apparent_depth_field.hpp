// How the apparent depth of light from inside goes over the field, where the probe was calibrated on a tooth-like
// ceramic (calib/model/light_inside.hpp): light and view meet the same surface at other angles in other places.
#pragma once

#include <array>
#include <cstddef>

namespace enamel::pipeline {

/// Shares of what enamel's law takes off. 1 everywhere by default. Immutable, thread-safe.
class ApparentDepthField {
 public:
  /// Share at column u: c[0] + s (c[1] + s c[2]), s = column(u).
  using Row = std::array<float, 3>;

  ApparentDepthField() = default;
  /// At the edges and the middle of a picture of that size, [down][across]; a parabola passes through each three.
  ApparentDepthField(const std::array<std::array<double, 3>, 3>& shares, int width, int height) noexcept;

  [[nodiscard]] Row row(int v) const noexcept;
  /// -1 to 1 over the picture.
  [[nodiscard]] float column(std::size_t u) const noexcept { return static_cast<float>(u) * per_column_ - 1; }

 private:
  std::array<std::array<float, 3>, 3> shares_ = {{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}};
  float per_column_ = 0, per_row_ = 0;
};

}  // namespace enamel::pipeline
