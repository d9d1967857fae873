// What blocks of an image say together, without those that see an edge. Private to pipeline/decode.
#pragma once

#include <algorithm>
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

}  // namespace enamel::pipeline
