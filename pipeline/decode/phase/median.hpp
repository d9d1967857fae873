// What blocks of an image say together, without those that see an edge. Private to pipeline/decode.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace enamel::pipeline {

/// The upper one of two middles; 0 of nothing. Reorders `values`.
[[nodiscard]] inline float median(std::vector<float>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// 0 of nothing.
[[nodiscard]] inline float root_mean_square(const std::vector<float>& values) {
  double sum = 0;
  for (const float x : values) sum += static_cast<double>(x) * static_cast<double>(x);
  return values.empty() ? 0 : static_cast<float>(std::sqrt(sum / static_cast<double>(values.size())));
}

}  // namespace enamel::pipeline
