// Who borders whom in a triangle mesh: directed edges, fans of faces round a vertex, pieces. Private to host/mesh_base.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace enamel::host {

using Triangle = std::array<std::uint32_t, 3>;

inline constexpr std::uint32_t kNoIndex = 0xFFFFFFFF;  ///< of no vertex, no fan

[[nodiscard]] constexpr std::uint64_t edge_key(std::uint32_t from, std::uint32_t to) noexcept {
  return std::uint64_t{from} << 32U | to;
}

/// Face of each directed edge; of several the first.
[[nodiscard]] std::unordered_map<std::uint64_t, std::uint32_t> directed_edges(std::span<const Triangle> triangles);

/// Number of each face's piece, 0 … pieces - 1 in order of its first face: faces that share an edge are of one piece.
struct Pieces {
  std::vector<std::uint32_t> of_face;
  std::uint32_t count = 0;
};
[[nodiscard]] Pieces pieces_of(std::span<const Triangle> triangles);

/// Fan of each corner (3 face + k): corners at one vertex whose faces share an edge there are of one fan. Returned are
/// roots: equal numbers, same fan.
[[nodiscard]] std::vector<std::uint32_t> fans_of(std::span<const Triangle> triangles);

}  // namespace enamel::host
