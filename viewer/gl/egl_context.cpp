#include "viewer/gl/egl_context.hpp"

#include <dlfcn.h>
#include <epoxy/egl.h>

#include <array>
#include <string>
#include <utility>

namespace enamel::view {

struct EglContext::Handles {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;

  Handles() = default;
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;
  ~Handles() {
    if (display == EGL_NO_DISPLAY) {
      return;
    }
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context != EGL_NO_CONTEXT) {
      eglDestroyContext(display, context);
    }
    eglTerminate(display);
    eglReleaseThread();
  }
};

namespace {

/// libepoxy ends the program when it cannot load a library; asking first turns that into an error value.
bool loadable(const char* library) {
  void* handle = dlopen(library, RTLD_LAZY | RTLD_LOCAL);
  if (handle == nullptr) {
    return false;
  }
  dlclose(handle);
  return true;
}

EGLContext make_context(EGLDisplay display) {
  constexpr std::array<std::pair<EGLint, EGLint>, 2> kVersions{{{4, 5}, {3, 3}}};
  const std::array<EGLint, 5> wanted{EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (eglChooseConfig(display, wanted.data(), &config, 1, &count) != EGL_TRUE || count < 1) {
    return EGL_NO_CONTEXT;
  }
  for (const auto& [major, minor] : kVersions) {
    const std::array<EGLint, 7> attributes{
        EGL_CONTEXT_MAJOR_VERSION,           major,   EGL_CONTEXT_MINOR_VERSION, minor, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
    if (context != EGL_NO_CONTEXT) {
      return context;
    }
  }
  return EGL_NO_CONTEXT;
}

}  // namespace

EglContext::EglContext(std::unique_ptr<Handles> handles) : handles_(std::move(handles)) {}
EglContext::~EglContext() = default;

Result<std::unique_ptr<EglContext>> EglContext::make() {
  if (!loadable("libEGL.so.1") || !loadable("libGL.so.1")) {
    return fail(ErrorCode::kDisplay, "libEGL.so.1 or libGL.so.1 is not installed (packages libegl1, libgl1)");
  }
  if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
    return fail(ErrorCode::kDisplay, "this EGL has no EGL_MESA_platform_surfaceless (package libegl-mesa0)");
  }
  auto handles = std::make_unique<Handles>();
  handles->display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (handles->display == EGL_NO_DISPLAY || eglInitialize(handles->display, nullptr, nullptr) != EGL_TRUE) {
    handles->display = EGL_NO_DISPLAY;
    return fail(ErrorCode::kDisplay, "EGL surfaceless does not start (package libgl1-mesa-dri)");
  }
  if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) {
    return fail(ErrorCode::kDisplay, "this EGL has no desktop OpenGL");
  }
  handles->context = make_context(handles->display);
  if (handles->context == EGL_NO_CONTEXT ||
      eglMakeCurrent(handles->display, EGL_NO_SURFACE, EGL_NO_SURFACE, handles->context) != EGL_TRUE) {
    return fail(ErrorCode::kDisplay, "EGL surfaceless gives no OpenGL 3.3 core context");
  }
  return std::unique_ptr<EglContext>(new EglContext(std::move(handles)));
}

}  // namespace enamel::view
