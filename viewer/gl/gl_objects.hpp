// Owners of GL names. A name is released in the context that made it, which must be current then.
#pragma once

#include <epoxy/gl.h>

#include <cstdint>
#include <utility>

namespace enamel::view {

/// GL takes offsets into a buffer as pointers.
[[nodiscard]] inline const void* buffer_offset(std::uintptr_t bytes) {
  return reinterpret_cast<const void*>(bytes);  // NOLINT(performance-no-int-to-ptr): GL's interface
}

template <class Kind>
class GlName {
 public:
  GlName() = default;
  [[nodiscard]] static GlName make() {
    GlName name;
    Kind::make(name.id_);
    return name;
  }
  [[nodiscard]] static GlName adopt(GLuint id) {
    GlName name;
    name.id_ = id;
    return name;
  }
  ~GlName() { reset(); }
  GlName(const GlName&) = delete;
  GlName& operator=(const GlName&) = delete;
  GlName(GlName&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  GlName& operator=(GlName&& other) noexcept {
    if (this != &other) {
      reset();
      id_ = std::exchange(other.id_, 0);
    }
    return *this;
  }
  [[nodiscard]] GLuint id() const noexcept { return id_; }
  explicit operator bool() const noexcept { return id_ != 0; }

 private:
  void reset() noexcept {
    if (id_ != 0) {
      Kind::release(id_);
      id_ = 0;
    }
  }
  GLuint id_ = 0;
};

struct BufferKind {
  static void make(GLuint& id) { glGenBuffers(1, &id); }
  static void release(GLuint id) noexcept { glDeleteBuffers(1, &id); }
};
struct VertexArrayKind {
  static void make(GLuint& id) { glGenVertexArrays(1, &id); }
  static void release(GLuint id) noexcept { glDeleteVertexArrays(1, &id); }
};
struct TextureKind {
  static void make(GLuint& id) { glGenTextures(1, &id); }
  static void release(GLuint id) noexcept { glDeleteTextures(1, &id); }
};
struct FramebufferKind {
  static void make(GLuint& id) { glGenFramebuffers(1, &id); }
  static void release(GLuint id) noexcept { glDeleteFramebuffers(1, &id); }
};
struct ProgramKind {
  static void make(GLuint& id) { id = glCreateProgram(); }
  static void release(GLuint id) noexcept { glDeleteProgram(id); }
};
struct ShaderKind {
  static void release(GLuint id) noexcept { glDeleteShader(id); }
};

using GlBuffer = GlName<BufferKind>;
using GlVertexArray = GlName<VertexArrayKind>;
using GlTexture = GlName<TextureKind>;
using GlFramebuffer = GlName<FramebufferKind>;
using GlProgram = GlName<ProgramKind>;
using GlShader = GlName<ShaderKind>;

}  // namespace enamel::view
