// Things by place: those near a point are found without asking all. Private to host/defects.
#pragma once

#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "pipeline/types/geometry.hpp"

namespace enamel::host {

/// A cube of space, along each axis: floor(p / edge).
using PlaceIndex = Eigen::Matrix<std::int64_t, 3, 1>;
[[nodiscard]] inline PlaceIndex place_index(const Vec3d& p_mm, double edge_mm) {
  return (p_mm / edge_mm).array().floor().matrix().cast<std::int64_t>();
}
/// One for each cube within 2^20 of the origin.
[[nodiscard]] inline std::uint64_t place_key(const PlaceIndex& i) {
  constexpr unsigned kBits = 21;
  constexpr std::uint64_t kMask = (1U << kBits) - 1;
  std::uint64_t out = 0;
  for (int k = 0; k < 3; ++k) out = out << kBits | (static_cast<std::uint64_t>(i[k]) & kMask);
  return out;
}

/// Not thread-safe while it grows.
class PlaceGrid {
 public:
  explicit PlaceGrid(double reach_mm) : reach_mm_(reach_mm) {}
  void add(const Vec3d& p, std::uint32_t what) { places_[place_key(place_index(p, reach_mm_))].push_back(what); }
  /// All within the reach, and some beyond, in a fixed order.
  template <class F>
  void near(const Vec3d& p, F&& with) const {
    const PlaceIndex at = place_index(p, reach_mm_);
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const auto found = places_.find(place_key(at + PlaceIndex(x, y, z)));
          if (found == places_.end()) continue;
          for (const std::uint32_t what : found->second) with(what);
        }
  }

 private:
  double reach_mm_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> places_;
};

}  // namespace enamel::host
