// Things by place: those near a point are found without asking all. Private to host/defects.
#pragma once

#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "pipeline/types/geometry.hpp"

namespace enamel::host {

/// Not thread-safe while it grows.
class PlaceGrid {
 public:
  explicit PlaceGrid(double reach_mm) : reach_mm_(reach_mm) {}
  void add(const Vec3d& p, std::uint32_t what) { places_[key(index(p))].push_back(what); }
  /// All within the reach, and some beyond, in a fixed order.
  template <class F>
  void near(const Vec3d& p, F&& with) const {
    const Index at = index(p);
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const auto found = places_.find(key(at + Index(x, y, z)));
          if (found == places_.end()) continue;
          for (const std::uint32_t what : found->second) with(what);
        }
  }

 private:
  using Index = Eigen::Matrix<std::int64_t, 3, 1>;
  [[nodiscard]] Index index(const Vec3d& p) const {
    return (p / reach_mm_).array().floor().matrix().cast<std::int64_t>();
  }
  [[nodiscard]] static std::uint64_t key(const Index& i) {
    constexpr std::uint64_t kMask = (1U << 21U) - 1;
    std::uint64_t out = 0;
    for (int k = 0; k < 3; ++k) out = out << 21U | (static_cast<std::uint64_t>(i[k]) & kMask);
    return out;
  }
  double reach_mm_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> places_;
};

}  // namespace enamel::host
