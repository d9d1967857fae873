// An OpenGL context without window or display server (EGL_MESA_platform_surfaceless).
#pragma once

#include <memory>

#include "protocol/base/result.hpp"

namespace enamel::view {

class EglContext {
 public:
  /// Makes the context and makes it current on this thread. Errors: kDisplay with the step that failed.
  [[nodiscard]] static Result<std::unique_ptr<EglContext>> make();
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

 private:
  struct Handles;
  explicit EglContext(std::unique_ptr<Handles> handles);
  std::unique_ptr<Handles> handles_;
};

}  // namespace enamel::view
