// A picture to draw into: RGBA8 colour and, if asked for, a depth texture.
#pragma once

#include "protocol/base/result.hpp"
#include "viewer/gl/gl_objects.hpp"

namespace enamel::view {

class RenderTarget {
 public:
  /// Errors: kDisplay when the driver refuses the size.
  [[nodiscard]] static Result<RenderTarget> make(int width, int height, bool with_depth);

  void bind() const;  ///< and sets the viewport
  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }
  [[nodiscard]] GLuint framebuffer() const noexcept { return framebuffer_.id(); }
  [[nodiscard]] GLuint colour() const noexcept { return colour_.id(); }
  [[nodiscard]] GLuint depth() const noexcept { return depth_.id(); }

 private:
  int width_ = 0;
  int height_ = 0;
  GlTexture colour_;
  GlTexture depth_;
  GlFramebuffer framebuffer_;
};

}  // namespace enamel::view
