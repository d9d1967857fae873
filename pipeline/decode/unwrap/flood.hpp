// Quality-guided unwrapping. Clean neighbours of a row are one run without more ado; the runs, and what lies between
// them, are joined best first: a maximum spanning forest, by 256 bucket heads and one intrusive list.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/decode/unwrap/links.hpp"

namespace enamel::pipeline {

/// Relative orders: inside one component Phi = phase + 2*pi*(wraps + k) with one k for the whole component, unless a
/// wrong link or a jump of a whole 2 pi lies inside it (order.hpp looks for those).
struct FloodMaps {
  Map<std::int16_t> wraps;
  Map<std::int32_t> component;  ///< -1 = none; numbered in row order
  std::int32_t components = 0;

  /// Pixels of one row that hang together by clean links.
  struct Run {
    std::int32_t row = 0, begin = 0, end = 0;
    std::int32_t parent = 0, size = 1;  ///< of the forest
    std::int32_t wraps = 0;             ///< of this run's zero over its parent's
  };
  /// Border of two runs: their zeros differ by `wraps` if it holds.
  struct Joint {
    std::int32_t first = 0, second = 0, wraps = 0, next = -1;
  };
  struct Work {  ///< kept between bursts
    std::vector<Run> runs;
    std::vector<Joint> joints;
    std::vector<std::int32_t> numbers;  ///< of the roots' components
    std::array<std::int32_t, 256> head{};
    std::vector<std::int32_t> upper, lower;  ///< runs of the pixels of two rows
    std::vector<std::int16_t> wrap_counts;   ///< a row border's, see flood_rows.hpp
    std::vector<std::uint8_t> weights, changes, marks;
  } work;
};

/// O(n) but for the forest's inverse Ackermann. Deterministic: ties within a bucket are last in, first out.
void flood(const Map<float>& phase_rad, const LinkMaps& links, FloodMaps& out);

}  // namespace enamel::pipeline
