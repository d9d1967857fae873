#include "tools/twin/optics/multi_patterns.hpp"

#include <cmath>
#include <numbers>

namespace enamel::twin {

MultiPatterns::Fringe MultiPatterns::fringe(int set) const {
  const auto i = static_cast<std::size_t>(set - 1);
  return {i >= cycles_.size(), cycles_[i % cycles_.size()]};
}

calib::PatternLevels MultiPatterns::levels(int set) const {
  constexpr double kWhite = 255, kBlack = 0;
  calib::PatternLevels out;
  if (set == 0) {
    for (std::size_t k = 0; k < 4; ++k)
      out.frames[k].assign(static_cast<std::size_t>(width_), k % 2 == 0 ? kWhite : kBlack);
    return out;
  }
  const Fringe f = fringe(set);
  out.axis_v = f.along_v;
  const int n = f.along_v ? height_ : width_;
  for (int k = 0; k < 4; ++k) {
    for (int i = 0; i < n; ++i) {
      const double phi = 2 * std::numbers::pi * f.cycles * i / n + k * std::numbers::pi / 2;
      out.frames[static_cast<std::size_t>(k)].push_back(mean_ + amplitude_ * std::cos(phi));
    }
  }
  return out;
}

std::array<std::string, 4> MultiPatterns::names(int set) const {
  if (set == 0) return {"white", "black", "white", "black"};
  const Fringe f = fringe(set);
  std::array<std::string, 4> names;
  for (std::size_t k = 0; k < 4; ++k)
    names[k] = std::string(f.along_v ? "h_" : "v_") + std::to_string(f.cycles) + "_" + std::to_string(k);
  return names;
}

}  // namespace enamel::twin
