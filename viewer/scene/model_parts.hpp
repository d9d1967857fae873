// The model's blocks by parts of 4 x 4 x 4, each with its coarse levels, made when they are first drawn; and the list
// of indices that is drawn of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "viewer/scene/coarse_mesh.hpp"
#include "viewer/scene/detail.hpp"
#include "viewer/scene/mesh_diff.hpp"

namespace enamel::view {

/// Not thread-safe.
class ModelParts {
 public:
  /// The block, well formed and with triangles, in place of its predecessor; its vertices begin at `base`.
  void put(std::shared_ptr<const BlockMesh> block, std::uint32_t base);
  void remove(const BlockIndex& index);

  /// What is drawn of the model, nearest part first, within `budget` triangles; at most kWorkTriangles triangles are
  /// made coarse in a call: parts that must wait are drawn as they are.
  [[nodiscard]] const std::vector<IndexTriangle>& select(const DetailView& view, std::size_t budget);
  /// Some part in view was drawn coarser than it is.
  [[nodiscard]] bool coarse() const noexcept { return coarse_; }

  /// The mesh as it is, from part `next` of those in view on, at most `budget` triangles or one part; `next` moves on,
  /// to nothing behind the last.
  [[nodiscard]] const std::vector<IndexTriangle>& exact(const DetailView& view, std::optional<std::size_t>& next,
                                                        std::size_t budget);

  [[nodiscard]] std::size_t triangles() const noexcept { return triangles_; }  ///< of the model
  [[nodiscard]] std::uint64_t revision() const noexcept { return revision_; }  ///< another after every change

  static constexpr std::size_t kWorkTriangles = 120'000;  ///< chosen: 5 ms
  static constexpr std::int32_t kPartBlocks = 4;          ///< a side

 private:
  struct Member {
    std::shared_ptr<const BlockMesh> mesh;
    std::uint32_t base = 0;
  };
  struct Part {
    std::map<BlockIndex, Member> members;
    std::size_t triangles = 0;
    std::optional<Ball> ball;
    std::array<std::optional<std::vector<IndexTriangle>>, kLevels> coarse;  ///< [0] is never made
    std::uint8_t last = 0;
  };
  static BlockIndex part_of(const BlockIndex& block);
  static void changed(Part& part);
  void list_parts();
  [[nodiscard]] const std::vector<IndexTriangle>& level_of(Part& part, std::size_t level);
  [[nodiscard]] bool make_levels(std::vector<DetailChoice>& chosen, std::size_t& work);
  void append_exact(const Part& part);

  std::map<BlockIndex, Part> parts_;
  std::vector<Part*> listed_;
  std::vector<DetailPart> seen_;
  CoarseMesher mesher_;
  std::vector<IndexTriangle> out_;
  std::size_t triangles_ = 0;
  std::uint64_t revision_ = 0;
  bool coarse_ = false;
};

}  // namespace enamel::view
