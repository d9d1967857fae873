// The model on the GPU: all blocks in one vertex and one index buffer, one draw call however many blocks there are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "protocol/base/result.hpp"
#include "viewer/gl/gl_objects.hpp"
#include "viewer/scene/colour.hpp"
#include "viewer/scene/mesh_diff.hpp"
#include "viewer/scene/slot_arena.hpp"
#include "viewer/scene/toggles.hpp"
#include "viewer/scene/view_camera.hpp"

namespace enamel::view {

class ModelPass {
 public:
  [[nodiscard]] static Result<std::unique_ptr<ModelPass>> make();

  /// Sends changed blocks up to the budget; the rest stays as it was and follows with the next calls.
  void update(const ModelSnapshot& model, std::size_t budget_bytes);

  /// Draws into the bound target. `height_px` is the target's height.
  void draw(const ViewCamera& camera, double aspect, int height_px, const DisplayToggles& toggles);

  void set_tone(const Colour& tone) noexcept { tone_ = tone; }

  [[nodiscard]] std::size_t triangles() const noexcept { return triangles_; }
  [[nodiscard]] std::size_t pending() const noexcept { return pending_; }
  [[nodiscard]] std::uint64_t uploaded_bytes() const noexcept { return uploaded_bytes_; }
  [[nodiscard]] int draw_calls() const noexcept { return draw_calls_; }

 private:
  struct Placed {
    Slot vertices;
    Slot triangles;         ///< counted in triangles, so that no slot begins inside one
    std::size_t count = 0;  ///< of real triangles in the slot
  };

  ModelPass() = default;
  void upload(const BlockMesh& block);
  void remove(const BlockIndex& index);
  void write_vertices(const BlockMesh& block, const Slot& slot);
  void write_triangles(const BlockMesh& block, const Placed& placed);
  void send_indices(const Slot& slot);
  void grow_buffers();
  void point_attributes() const;

  Colour tone_ = kTooth;
  GlProgram program_;
  GlVertexArray vertex_array_;
  GlBuffer vertices_;
  GlBuffer indices_;
  std::size_t vertex_room_ = 0;
  std::size_t triangle_room_ = 0;
  SlotArena vertex_arena_{std::size_t{1} << 15};
  SlotArena triangle_arena_{std::size_t{1} << 16};
  MeshDiff diff_;
  std::map<BlockIndex, Placed> placed_;
  std::size_t triangles_ = 0;
  std::size_t pending_ = 0;
  std::uint64_t uploaded_bytes_ = 0;
  int draw_calls_ = 0;
  std::vector<std::uint8_t> bytes_;
  std::vector<std::uint32_t> index_scratch_;
};

}  // namespace enamel::view
