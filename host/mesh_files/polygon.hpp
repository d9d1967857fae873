// Faces of more than three corners.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/types/geometry.hpp"

namespace enamel::host {

/// `fan`: the triangles (0 1 2), (0 2 3) … of one polygon over `positions`. Where one of them is folded over, because
/// the polygon has dents, others of the same corners take their place: ears cut off one by one (Meisters 1975) in the
/// plane of Newell's normal. A polygon that crosses itself or has a corner that is not finite stays a fan. Every point
/// looked at costs 1 of `budget`; without it fans stay, so that no file holds a reader up.
void unfold_fan(std::span<std::array<std::uint32_t, 3>> fan, const std::vector<Vec3d>& positions,
                std::uint64_t& budget);

}  // namespace enamel::host
