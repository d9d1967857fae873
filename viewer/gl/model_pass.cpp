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

constexpr float kLeastSoft = -1.0F / 32767.0F;  // of a quality of 0: the largest number below 0 that the GPU is told

struct GpuVertex {
  std::array<float, 3> position;
  std::array<std::int16_t, 4> normal_quality;
};
static_assert(sizeof(GpuVertex) == kGpuVertexBytes);

/// Light is added linear: colours are sRGB of gamma 2.2.
Colour linear(const Colour& c) { return {std::pow(c.r, 2.2F), std::pow(c.g, 2.2F), std::pow(c.b, 2.2F)}; }

/// A buffer of `bytes`, the first `kept` of them copied from `old`.
GlBuffer enlarged(const GlBuffer& old, std::size_t kept, std::size_t bytes) {
  GlBuffer buffer = GlBuffer::make();
  glBindBuffer(GL_COPY_WRITE_BUFFER, buffer.id());
  glBufferData(GL_COPY_WRITE_BUFFER, static_cast<GLsizeiptr>(bytes), nullptr, GL_DYNAMIC_DRAW);
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
  pass->indices_ = GlBuffer::make();
  pass->grow_buffer();
  return pass;
}

void ModelPass::grow_buffer() {
  if (vertex_arena_.capacity() > vertex_room_) {
    vertices_ = enlarged(vertices_, vertex_room_ * kGpuVertexBytes, vertex_arena_.capacity() * kGpuVertexBytes);
    vertex_room_ = vertex_arena_.capacity();
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
    upload(block);
  }
  pending_ = plan.pending;
}

void ModelPass::upload(const std::shared_ptr<const BlockMesh>& block) {
  auto known = placed_.find(block->block);
  if (known != placed_.end() && (block->triangles.empty() || known->second.size < block->vertices.size())) {
    remove(block->block);
    known = placed_.end();
  }
  if (block->triangles.empty()) {
    return;
  }
  if (known == placed_.end()) {
    known = placed_.emplace(block->block, vertex_arena_.allocate(with_slack(block->vertices.size()))).first;
    grow_buffer();
  }
  write_vertices(*block, known->second);
  parts_.put(block, static_cast<std::uint32_t>(known->second.offset));
  uploaded_bytes_ += gpu_bytes(*block);
}

void ModelPass::write_vertices(const BlockMesh& block, const Slot& slot) {
  bytes_.resize(block.vertices.size() * kGpuVertexBytes);
  for (std::size_t i = 0; i < block.vertices.size(); ++i) {
    const Vec3f& p = block.vertices[i];
    const Vec3f n = block.normals.empty() ? Vec3f(0, 0, -1) : block.normals[i];
    const float q = block.quality.empty() ? 0.0F : block.quality[i];
    const bool soft = !block.soft.empty() && block.soft[i] != 0;
    const float told = soft ? std::min(-q, kLeastSoft) : q;
    const GpuVertex vertex{{p.x(), p.y(), p.z()}, {snorm16(n.x()), snorm16(n.y()), snorm16(n.z()), snorm16(told)}};
    std::memcpy(bytes_.data() + i * kGpuVertexBytes, &vertex, kGpuVertexBytes);
  }
  glBindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  glBufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(slot.offset * kGpuVertexBytes),
                  static_cast<GLsizeiptr>(bytes_.size()), bytes_.data());
}

void ModelPass::remove(const BlockIndex& index) {
  const auto known = placed_.find(index);
  if (known == placed_.end()) {
    return;
  }
  parts_.remove(index);
  vertex_arena_.release(known->second);
  placed_.erase(known);
}

void ModelPass::draw(const DetailView& view, const DisplayToggles& toggles, std::size_t budget) {
  draw_listed(parts_.select(view, budget), view, toggles);
}

void ModelPass::draw_exact(const DetailView& view, const DisplayToggles& toggles, std::optional<std::size_t>& next,
                           std::size_t budget) {
  draw_listed(parts_.exact(view, next, budget), view, toggles);
}

void ModelPass::draw_listed(const std::vector<IndexTriangle>& triangles, const DetailView& view,
                            const DisplayToggles& toggles) {
  draw_calls_ = 0;
  drawn_triangles_ = triangles.size();
  if (triangles.empty()) {
    return;
  }
  glUseProgram(program_.id());
  set_uniform(program_, "view", view_matrix(view.camera));
  set_uniform(program_, "projection", projection_matrix(view.camera, view.aspect));
  set_uniform(program_, "soft_tone", linear(toggles.mono ? kMonoGrey : kSoftTone));
  set_uniform(program_, "hide_soft", toggles.soft_tissue ? 0.0F : 1.0F);
  set_uniform(program_, "albedo", linear(toggles.mono && tone_ == kTooth ? kMonoGrey : tone_));
  set_uniform(program_, "ramp_low", linear(kQualityRamp[0]));
  set_uniform(program_, "ramp_mid", linear(kQualityRamp[1]));
  set_uniform(program_, "ramp_high", linear(kQualityRamp[2]));
  set_uniform(program_, "ramp_share", toggles.quality_map ? 1.0F : 0.0F);
  set_uniform(program_, "gloss", toggles.mono || toggles.quality_map ? 0.0F : 1.0F);
  const double height_mm = 2 * view.camera.distance_mm * std::tan(0.5 * view.camera.fov_y_rad);
  set_uniform(program_, "mm_per_px", static_cast<float>(height_mm / std::max(view.height_px, 1)));
  glBindVertexArray(vertex_array_.id());
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(triangles.size() * kGpuTriangleBytes), triangles.data(),
               GL_STREAM_DRAW);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * triangles.size()), GL_UNSIGNED_INT, nullptr);
  glBindVertexArray(0);
  draw_calls_ = 1;
}

}  // namespace enamel::view
