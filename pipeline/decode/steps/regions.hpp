// Second step of a burst: pixels that lie on one surface, and how many fringes they are apart.
#pragma once

#include "pipeline/decode/unwrap/flood.hpp"
#include "pipeline/decode/unwrap/links.hpp"

namespace enamel::pipeline {

/// Connected components, unwrapped within themselves: fringe orders up to one number each. Keeps its memory.
struct Regions {
  LinkMaps links;   ///< which neighbours lie on one surface, and the quality of each pixel
  FloodMaps flood;  ///< components and the wrap count of each pixel in its own
};

/// Share of neighbouring pairs that follow the rig's fringe carrier. A picture one pixel wide has no pairs, and nothing
/// that speaks against it: 1.
[[nodiscard]] inline double linked_share(const LinkMaps& links) noexcept {
  return links.pairs > 0 ? static_cast<double>(links.linked) / static_cast<double>(links.pairs) : 1;
}

}  // namespace enamel::pipeline
