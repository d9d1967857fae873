// Lines of constant width on the screen and translucent faces: the probe's field and its path.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "pipeline/types/geometry.hpp"
#include "protocol/base/result.hpp"
#include "viewer/gl/gl_objects.hpp"
#include "viewer/scene/colour.hpp"

namespace enamel::view {

struct Tint {
  Colour colour;
  float alpha = 1;
};

/// A list of shapes that is sent as one buffer.
class LineBatch {
 public:
  void line(const Vec3f& from, const Vec3f& to, const Tint& tint_from, const Tint& tint_to);
  void triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Tint& tint);
  void clear() { vertices_.clear(); }
  [[nodiscard]] bool empty() const noexcept { return vertices_.empty(); }

 private:
  friend class LinePass;
  struct Vertex {
    Vec3f from, to;
    Vec2f corner;
    Colour colour;
    float alpha;
  };
  std::vector<Vertex> vertices_;
};

class LinePass {
 public:
  [[nodiscard]] static Result<std::unique_ptr<LinePass>> make();

  struct View {
    Eigen::Matrix4f view_projection;
    int width_px = 0;
    int height_px = 0;
  };
  /// Lines of `width_px`, or triangles when it is 0. Parts behind the model are drawn with `hidden_opacity`.
  void draw(const LineBatch& batch, const View& view, float width_px, float opacity, float hidden_opacity);

 private:
  LinePass() = default;
  GlProgram program_;
  GlVertexArray vertex_array_;
  GlBuffer buffer_;
};

}  // namespace enamel::view
