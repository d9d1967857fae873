#include "viewer/gl/render_target.hpp"

#include <string>

namespace enamel::view {
namespace {

GlTexture texture(int width, int height, GLint internal, GLenum format, GLenum type) {
  GlTexture out = GlTexture::make();
  glBindTexture(GL_TEXTURE_2D, out.id());
  glTexImage2D(GL_TEXTURE_2D, 0, internal, width, height, 0, format, type, nullptr);
  const GLint filter = format == GL_DEPTH_COMPONENT ? GL_NEAREST : GL_LINEAR;
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return out;
}

}  // namespace

Result<RenderTarget> RenderTarget::make(int width, int height, bool with_depth) {
  RenderTarget target;
  target.width_ = width;
  target.height_ = height;
  target.colour_ = texture(width, height, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE);
  target.framebuffer_ = GlFramebuffer::make();
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer_.id());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, target.colour_.id(), 0);
  if (with_depth) {
    target.depth_ = texture(width, height, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, target.depth_.id(), 0);
  }
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    return fail(ErrorCode::kDisplay,
                "the graphics driver refused a picture of " + std::to_string(width) + " x " + std::to_string(height));
  }
  return target;
}

void RenderTarget::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  glViewport(0, 0, width_, height_);
}

}  // namespace enamel::view
