// Quality-guided unwrapping: a flood over linked pixels, best quality first, with 256 bucket heads and one intrusive
// list.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/algo/unwrap/links.hpp"

namespace enamel::algo {

/// Relative orders: inside one component Phi = phase + 2*pi*(turn + k) with one k for the whole component, unless a
/// wrong link or a jump of a whole 2 pi lies inside it (order.hpp looks for those).
struct FloodMaps {
  Map<std::int16_t> turn;
  Map<std::int32_t> component;  ///< -1 = none; numbered from the best seed on
  std::int32_t components = 0;

  struct Work {  ///< kept between bursts
    std::vector<std::int32_t> next;
    std::vector<std::int32_t> seeds;
    std::array<std::int32_t, 256> head{};
  } work;
};

/// O(n). Deterministic: ties within a bucket are last in, first out.
void flood(const Map<float>& phase_rad, const LinkMaps& links, FloodMaps& out);

}  // namespace enamel::algo
