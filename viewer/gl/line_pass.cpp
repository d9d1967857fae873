#include "viewer/gl/line_pass.hpp"

#include "viewer/gl/shader.hpp"

namespace enamel::view {

void LineBatch::line(const Vec3f& from, const Vec3f& to, const Tint& tint_from, const Tint& tint_to) {
  const auto corner = [&](float end, float side) {
    const Tint& tint = end < 0.5F ? tint_from : tint_to;
    vertices_.push_back({from, to, Vec2f{end, side}, tint.colour, tint.alpha});
  };
  corner(0, -1);
  corner(1, -1);
  corner(1, 1);
  corner(0, -1);
  corner(1, 1);
  corner(0, 1);
}

void LineBatch::triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Tint& tint) {
  for (const Vec3f& p : {a, b, c}) {
    vertices_.push_back({p, p, Vec2f::Zero(), tint.colour, tint.alpha});
  }
}

Result<std::unique_ptr<LinePass>> LinePass::make() {
  using Vertex = LineBatch::Vertex;
  std::unique_ptr<LinePass> pass(new LinePass);
  ENAMEL_TRY_ASSIGN(pass->program_, build_program("line", glsl::kLineVertex, glsl::kLineFragment));
  pass->vertex_array_ = GlVertexArray::make();
  pass->buffer_ = GlBuffer::make();
  glBindVertexArray(pass->vertex_array_.id());
  glBindBuffer(GL_ARRAY_BUFFER, pass->buffer_.id());
  const auto attribute = [](GLuint location, GLint count, std::size_t offset) {
    glEnableVertexAttribArray(location);
    glVertexAttribPointer(location, count, GL_FLOAT, GL_FALSE, sizeof(Vertex), buffer_offset(offset));
  };
  attribute(0, 3, offsetof(Vertex, from));
  attribute(1, 3, offsetof(Vertex, to));
  attribute(2, 2, offsetof(Vertex, corner));
  attribute(3, 4, offsetof(Vertex, colour));
  glBindVertexArray(0);
  return pass;
}

void LinePass::draw(const LineBatch& batch, const View& view, float width_px, float opacity, float hidden_opacity) {
  if (batch.empty()) {
    return;
  }
  glBindVertexArray(vertex_array_.id());
  glBindBuffer(GL_ARRAY_BUFFER, buffer_.id());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(batch.vertices_.size() * sizeof(LineBatch::Vertex)),
               batch.vertices_.data(), GL_STREAM_DRAW);
  glUseProgram(program_.id());
  set_uniform(program_, "view_projection", view.view_projection);
  set_uniform(program_, "viewport",
              Eigen::Vector2f(static_cast<float>(view.width_px), static_cast<float>(view.height_px)));
  set_uniform(program_, "width_px", width_px);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  const auto count = static_cast<GLsizei>(batch.vertices_.size());
  if (hidden_opacity > 0) {
    glDepthFunc(GL_GREATER);
    set_uniform(program_, "opacity", hidden_opacity);
    glDrawArrays(GL_TRIANGLES, 0, count);
  }
  glDepthFunc(GL_LEQUAL);
  set_uniform(program_, "opacity", opacity);
  glDrawArrays(GL_TRIANGLES, 0, count);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LESS);
  glDisable(GL_BLEND);
  glBindVertexArray(0);
}

}  // namespace enamel::view
