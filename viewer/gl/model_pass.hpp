// The model on the GPU: the vertices of all blocks in one buffer, the triangles that a picture is made of in another,
// written anew for each: one draw call however many blocks there are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "protocol/base/result.hpp"
#include "viewer/gl/gl_objects.hpp"
#include "viewer/scene/colour.hpp"
#include "viewer/scene/detail.hpp"
#include "viewer/scene/mesh_diff.hpp"
#include "viewer/scene/model_parts.hpp"
#include "viewer/scene/slot_arena.hpp"
#include "viewer/scene/toggles.hpp"

namespace enamel::view {

class ModelPass {
 public:
  [[nodiscard]] static Result<std::unique_ptr<ModelPass>> make();

  /// Sends changed blocks up to the budget; the rest stays as it was and follows with the next calls.
  void update(const ModelSnapshot& model, std::size_t budget_bytes);

  /// Draws into the bound target, of `view.height_px`, at most `budget` triangles where coarse levels allow it.
  void draw(const DetailView& view, const DisplayToggles& toggles, std::size_t budget);
  /// Draws the mesh as it is, from `next` on; call until `next` is empty.
  void draw_exact(const DetailView& view, const DisplayToggles& toggles, std::optional<std::size_t>& next,
                  std::size_t budget);

  void set_tone(const Colour& tone) noexcept { tone_ = tone; }

  [[nodiscard]] std::size_t triangles() const noexcept { return parts_.triangles(); }  ///< of the model
  [[nodiscard]] std::size_t drawn_triangles() const noexcept { return drawn_triangles_; }
  [[nodiscard]] bool coarse() const noexcept { return parts_.coarse(); }               ///< in the last draw()
  [[nodiscard]] std::uint64_t revision() const noexcept { return parts_.revision(); }  ///< another after every change
  [[nodiscard]] std::size_t pending() const noexcept { return pending_; }
  [[nodiscard]] std::uint64_t uploaded_bytes() const noexcept { return uploaded_bytes_; }
  [[nodiscard]] int draw_calls() const noexcept { return draw_calls_; }

 private:
  ModelPass() = default;
  void upload(const std::shared_ptr<const BlockMesh>& block);
  void remove(const BlockIndex& index);
  void write_vertices(const BlockMesh& block, const Slot& slot);
  void grow_buffer();
  void point_attributes() const;
  void draw_listed(const std::vector<IndexTriangle>& triangles, const DetailView& view, const DisplayToggles& toggles);

  Colour tone_ = kTooth;
  GlProgram program_;
  GlVertexArray vertex_array_;
  GlBuffer vertices_;
  GlBuffer indices_;
  std::size_t vertex_room_ = 0;
  SlotArena vertex_arena_{std::size_t{1} << 15};
  MeshDiff diff_;
  std::map<BlockIndex, Slot> placed_;
  ModelParts parts_;
  std::size_t drawn_triangles_ = 0;
  std::size_t pending_ = 0;
  std::uint64_t uploaded_bytes_ = 0;
  int draw_calls_ = 0;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace enamel::view
