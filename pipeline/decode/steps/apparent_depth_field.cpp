#include "pipeline/decode/steps/apparent_depth_field.hpp"

#include <algorithm>

namespace enamel::pipeline {
namespace {

/// Through first, middle, last at -1, 0, 1.
ApparentDepthField::Row parabola(float first, float middle, float last) {
  return {middle, 0.5F * (last - first), 0.5F * (last + first) - middle};
}

}  // namespace

ApparentDepthField::ApparentDepthField(const std::array<std::array<double, 3>, 3>& shares, int width,
                                       int height) noexcept
    : per_column_(2.0F / static_cast<float>(std::max(1, width - 1))),
      per_row_(2.0F / static_cast<float>(std::max(1, height - 1))) {
  for (std::size_t v = 0; v < 3; ++v)
    for (std::size_t u = 0; u < 3; ++u) shares_[v][u] = static_cast<float>(shares[v][u]);
}

ApparentDepthField::Row ApparentDepthField::row(int v) const noexcept {
  const float s = static_cast<float>(v) * per_row_ - 1;
  std::array<float, 3> across{};
  for (std::size_t u = 0; u < 3; ++u) {
    const auto [middle, linear, square] = parabola(shares_[0][u], shares_[1][u], shares_[2][u]);
    across[u] = middle + s * (linear + s * square);
  }
  return parabola(across[0], across[1], across[2]);
}

}  // namespace enamel::pipeline
