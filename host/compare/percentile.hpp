#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace enamel::host {

/// Linear between the sorted values next to it. Precondition: not empty.
[[nodiscard]] inline double percentile(const std::vector<double>& sorted, double share) {
  const auto last = static_cast<double>(sorted.size() - 1);
  const auto at = static_cast<std::size_t>(share * last);
  const double part = share * last - static_cast<double>(at);
  const double next = sorted[std::min(at + 1, sorted.size() - 1)];
  return sorted[at] + part * (next - sorted[at]);
}

}  // namespace enamel::host
