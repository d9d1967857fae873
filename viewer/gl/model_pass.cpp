#include "viewer/gl/model_pass.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "viewer/gl/shader.hpp"

namespace enamel::view {
namespace {

/// Room to grow in place: a block that is scanned changes size with every burst.
std::size_t with_slack(std::size_t n) { return std::max<std::size_t>(n + n / 4, 1); }

std::int16_t snorm16(float v) {
  const float clamped = std::isfinite(v) ? std::clamp(v, -1.0F, 1.0F) : 0.0F;
  return static_cast<std::int16_t>(std::lround(clamped * 32767.0F));
}

struct GpuVertex {
  std::array<float, 3> position;
  std::array<std::int16_t, 4> normal_quality;
};
static_assert(sizeof(GpuVertex) == kGpuVertexBytes);

/// A buffer of `bytes`, the first `kept` of them copied from `old`.
GlBuffer enlarged(const GlBuffer& old, std::size_t kept, std::size_t bytes) {
  GlBuffer buffer = GlBuffer::make();
  glBindBuffer(GL_COPY_WRITE_BUFFER, buffer.id());
  const std::vector<std::uint8_t> zeros(bytes, 0);  // index 0 three times: a triangle without area
  glBufferData(GL_COPY_WRITE_BUFFER, static_cast<GLsizeiptr>(bytes), zeros.data(), GL_DYNAMIC_DRAW);
  if (old && kept > 0) {
    glBindBuffer(GL_COPY_READ_BUFFER, old.id());
    glCopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, 0, 0, static_cast<GLsizeiptr>(kept));
  }
  return buffer;
}

}  // namespace

Result<std::unique_ptr<ModelPass>> ModelPass::make() {
  std::unique_ptr<ModelPass> pass(new ModelPass);
  ENAMEL_TRY_ASSIGN(pass->program_, build_program("model", glsl::kModelVertex, glsl::kModelFragment));
  pass->vertex_array_ = GlVertexArray::make();
  pass->grow_buffers();
  return pass;
}

void ModelPass::grow_buffers() {
  if (vertex_arena_.capacity() > vertex_room_) {
    vertices_ = enlarged(vertices_, vertex_room_ * kGpuVertexBytes, vertex_arena_.capacity() * kGpuVertexBytes);
    vertex_room_ = vertex_arena_.capacity();
    point_attributes();
  }
  if (triangle_arena_.capacity() > triangle_room_) {
    indices_ = enlarged(indices_, triangle_room_ * kGpuTriangleBytes, triangle_arena_.capacity() * kGpuTriangleBytes);
    triangle_room_ = triangle_arena_.capacity();
    point_attributes();
  }
}

void ModelPass::point_attributes() const {
  glBindVertexArray(vertex_array_.id());
  glBindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, kGpuVertexBytes, nullptr);
  glEnableVertexAttribArray(1);
  glVertexAttribPointer(1, 4, GL_SHORT, GL_TRUE, kGpuVertexBytes, buffer_offset(offsetof(GpuVertex, normal_quality)));
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  glBindVertexArray(0);
}

void ModelPass::update(const ModelSnapshot& model, std::size_t budget_bytes) {
  const UploadPlan plan = diff_.plan(model, budget_bytes);
  for (const BlockIndex& index : plan.remove) {
    remove(index);
  }
  for (const auto& block : plan.upload) {
    upload(*block);
  }
  pending_ = plan.pending;
}

void ModelPass::upload(const BlockMesh& block) {
  auto known = placed_.find(block.block);
  const std::size_t count = block.triangles.size();
  if (known != placed_.end() &&
      (known->second.vertices.size < block.vertices.size() || known->second.triangles.size < count)) {
    remove(block.block);
    known = placed_.end();
  }
  if (count == 0) {
    if (known != placed_.end()) {
      remove(block.block);
    }
    return;
  }
  if (known == placed_.end()) {
    Placed place{vertex_arena_.allocate(with_slack(block.vertices.size())), triangle_arena_.allocate(with_slack(count)),
                 0};
    grow_buffers();
    known = placed_.emplace(block.block, place).first;
  }
  Placed& placed = known->second;
  triangles_ += count;
  triangles_ -= placed.count;
  placed.count = count;
  write_vertices(block, placed.vertices);
  write_triangles(block, placed);
  uploaded_bytes_ += gpu_bytes(block);
}

void ModelPass::write_vertices(const BlockMesh& block, const Slot& slot) {
  bytes_.resize(block.vertices.size() * kGpuVertexBytes);
  for (std::size_t i = 0; i < block.vertices.size(); ++i) {
    const Vec3f& p = block.vertices[i];
    const Vec3f n = block.normals.empty() ? Vec3f(0, 0, -1) : block.normals[i];
    const float q = block.quality.empty() ? 0.0F : block.quality[i];
    const GpuVertex vertex{{p.x(), p.y(), p.z()}, {snorm16(n.x()), snorm16(n.y()), snorm16(n.z()), snorm16(q)}};
    std::memcpy(bytes_.data() + i * kGpuVertexBytes, &vertex, kGpuVertexBytes);
  }
  glBindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  glBufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(slot.offset * kGpuVertexBytes),
                  static_cast<GLsizeiptr>(bytes_.size()), bytes_.data());
}

void ModelPass::write_triangles(const BlockMesh& block, const Placed& placed) {
  const auto base = static_cast<std::uint32_t>(placed.vertices.offset);
  index_scratch_.assign(3 * placed.triangles.size, 0);  // what is left of the slot stays without area
  std::size_t at = 0;
  for (const auto& triangle : block.triangles) {
    for (const std::uint32_t index : triangle) {
      index_scratch_[at++] = base + index;
    }
  }
  send_indices(placed.triangles);
}

void ModelPass::send_indices(const Slot& slot) {
  glBindBuffer(GL_COPY_WRITE_BUFFER, indices_.id());
  glBufferSubData(GL_COPY_WRITE_BUFFER, static_cast<GLintptr>(slot.offset * kGpuTriangleBytes),
                  static_cast<GLsizeiptr>(slot.size * kGpuTriangleBytes), index_scratch_.data());
}

void ModelPass::remove(const BlockIndex& index) {
  const auto known = placed_.find(index);
  if (known == placed_.end()) {
    return;
  }
  const Placed& placed = known->second;
  index_scratch_.assign(3 * placed.triangles.size, 0);
  send_indices(placed.triangles);
  vertex_arena_.release(placed.vertices);
  triangle_arena_.release(placed.triangles);
  triangles_ -= placed.count;
  placed_.erase(known);
}

void ModelPass::draw(const ViewCamera& camera, double aspect, int height_px, const DisplayToggles& toggles) {
  draw_calls_ = 0;
  if (triangles_ == 0) {
    return;
  }
  glUseProgram(program_.id());
  set_uniform(program_, "view", view_matrix(camera));
  set_uniform(program_, "projection", projection_matrix(camera, aspect));
  set_uniform(program_, "albedo", toggles.mono && tone_ == kTooth ? kMonoGrey : tone_);
  set_uniform(program_, "ramp_low", kQualityRamp[0]);
  set_uniform(program_, "ramp_mid", kQualityRamp[1]);
  set_uniform(program_, "ramp_high", kQualityRamp[2]);
  set_uniform(program_, "ramp_share", toggles.quality_map ? 1.0F : 0.0F);
  set_uniform(program_, "gloss", toggles.mono || toggles.quality_map ? 0.0F : 1.0F);
  const double height_mm = 2 * camera.distance_mm * std::tan(0.5 * camera.fov_y_rad);
  set_uniform(program_, "mm_per_px", static_cast<float>(height_mm / std::max(height_px, 1)));
  glBindVertexArray(vertex_array_.id());
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * triangle_arena_.end()), GL_UNSIGNED_INT, nullptr);
  glBindVertexArray(0);
  draw_calls_ = 1;
}

}  // namespace enamel::view
