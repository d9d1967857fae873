#include "calib/model/projector_response.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>

namespace enamel::calib {
namespace {

constexpr std::size_t kMinLevels = 3;
constexpr double kRounding = 1e-9;  ///< of the end points, which a file states in decimals

template <class Values>
bool rises(const Values& values) {
  return std::adjacent_find(values.begin(), values.end(), std::not_fn(std::less<>())) == values.end();
}

}  // namespace

bool is_rising(const ProjectorResponse& r) noexcept {
  if (r.level.size() < kMinLevels || r.emission.size() != r.level.size()) return false;
  if (r.level.front() < 0 || r.level.back() > 255) return false;
  if (!(std::abs(r.emission.front()) < kRounding && std::abs(r.emission.back() - 1) < kRounding)) return false;
  return rises(r.level) && rises(r.emission);
}

double level_for(const ProjectorResponse& r, double wanted) noexcept {
  const double first = r.level.front(), last = r.level.back();
  if (!(wanted > first && wanted < last)) return wanted;
  const double emission = (wanted - first) / (last - first);
  const auto above = std::upper_bound(r.emission.begin() + 1, r.emission.end() - 1, emission) - r.emission.begin();
  const auto high = static_cast<std::size_t>(above), low = high - 1;
  const double share = (emission - r.emission[low]) / (r.emission[high] - r.emission[low]);
  return r.level[low] + share * (r.level[high] - r.level[low]);
}

}  // namespace enamel::calib
