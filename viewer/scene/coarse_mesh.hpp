// A surface with fewer triangles, made of the vertices that it has: those in one cell of a grid become the one of them
// that is nearest to the cell's middle. Vertices on the edge of a part go by themselves, so that parts beside each
// other which were made coarse by the same cell meet.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/types/model_snapshot.hpp"

namespace enamel::view {

using IndexTriangle = std::array<std::uint32_t, 3>;

/// A well-formed block whose vertices begin at `base` of a buffer that others share.
struct MeshPart {
  const BlockMesh* mesh = nullptr;
  std::uint32_t base = 0;
};

/// Keeps its working memory. Not thread-safe.
class CoarseMesher {
 public:
  /// What is left of the triangles of `parts`, as indices into the shared buffer. Every point of it lies within the
  /// diagonal of a cell of the surface; pieces that fit into a cell vanish. Vertices of equal coordinates are one.
  /// cell_mm > 0.
  [[nodiscard]] std::vector<IndexTriangle> coarser(std::span<const MeshPart> parts, float cell_mm);

 private:
  struct Vertex {
    Vec3f position = Vec3f::Zero();
    std::uint32_t index = 0;       ///< in the shared buffer
    std::uint32_t stands_for = 0;  ///< place of its cluster in table_
    std::int64_t turn = 0;         ///< 0: its triangles close around it
  };
  void weld(std::span<const MeshPart> parts);
  void find_border(std::span<const MeshPart> parts);
  void choose(float cell_mm);
  [[nodiscard]] bool touches(const Vertex& vertex, std::size_t side) const;
  [[nodiscard]] std::uint64_t cluster_key(const Vertex& vertex, float cell_mm) const;

  std::vector<std::uint32_t> table_;   ///< open addressing, of welded vertices or clusters
  std::vector<std::uint32_t> welded_;  ///< of each vertex of the parts, in order
  std::vector<Vertex> vertices_;       ///< welded
  std::vector<std::uint64_t> keys_;    ///< of the clusters' places in table_
  std::array<bool, 6> cut_{};          ///< of the sides low x, high x, low y … of the part's box
  Vec3f lowest_ = Vec3f::Zero(), highest_ = Vec3f::Zero();
};

}  // namespace enamel::view
