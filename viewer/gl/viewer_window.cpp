#include "viewer/gl/viewer_window.hpp"

#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "viewer/gl/viewer_core.hpp"
#include "viewer/gl/window_input.hpp"
#include "viewer/scene/detail.hpp"
#include "viewer/scene/frame_pacer.hpp"
#include "viewer/scene/same_picture.hpp"

namespace enamel::view {
namespace {

std::string last_glfw_error() {
  const char* text = nullptr;
  const int code = glfwGetError(&text);
  return code == GLFW_NO_ERROR || text == nullptr ? "no reason given" : text;
}

struct GlfwWindow {
  GLFWwindow* handle = nullptr;
  bool initialised = false;

  GlfwWindow() = default;
  GlfwWindow(const GlfwWindow&) = delete;
  GlfwWindow& operator=(const GlfwWindow&) = delete;
  ~GlfwWindow() {
    if (handle != nullptr) {
      glfwDestroyWindow(handle);
    }
    if (initialised) {
      glfwTerminate();
    }
  }
};

double seconds(Nanoseconds time) { return 1e-9 * static_cast<double>(time.count()); }

Result<void> create(GlfwWindow& window, const ViewerOptions& options) {
  if (glfwInit() != GLFW_TRUE) {
    return fail(ErrorCode::kDisplay, "GLFW: " + last_glfw_error());
  }
  window.initialised = true;
  constexpr std::array<std::pair<int, int>, 2> kVersions{{{4, 5}, {3, 3}}};
  std::string tried;
  for (const auto& [major, minor] : kVersions) {
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, major);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, minor);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_VISIBLE, options.visible ? GLFW_TRUE : GLFW_FALSE);
    glfwWindowHint(GLFW_DEPTH_BITS, 0);  // the scene has its own depth
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    window.handle = glfwCreateWindow(options.width, options.height, options.title.c_str(), nullptr, nullptr);
    if (window.handle != nullptr) {
      return {};
    }
    tried += "OpenGL " + std::to_string(major) + "." + std::to_string(minor) + ": " + last_glfw_error() + "; ";
  }
  return fail(ErrorCode::kDisplay, tried);
}

}  // namespace

struct ViewerWindow::Impl {
  Impl(const ViewerOptions& wanted, Clock& time)
      : options(wanted),
        clock(time),
        pacer(wanted.max_fps, {wanted.max_busy_share, wanted.yielding_share}),
        detail(wanted.frame_ms, wanted.triangle_budget) {}
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    if (core) {
      glfwMakeContextCurrent(window.handle);
      core->activate();
      if (imgui_connected) {
        ImGui_ImplGlfw_Shutdown();
      }
    }
  }

  [[nodiscard]] Result<void> draw(std::shared_ptr<const PreviewFrame> frame, const DrawRequest& request) {
    glfwMakeContextCurrent(window.handle);
    core->activate();
    ImGui_ImplGlfw_NewFrame();
    return core->draw(std::move(frame), request);
  }

  void show(int width, int height) {
    const RenderTarget& picture = core->picture_target();
    glBindFramebuffer(GL_READ_FRAMEBUFFER, picture.framebuffer());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glBlitFramebuffer(0, 0, picture.width(), picture.height(), 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glfwSwapBuffers(window.handle);
  }

  [[nodiscard]] bool fits(const DrawRequest& request) const {
    return core->picture_target().width() == request.width && core->picture_target().height() == request.height;
  }

  [[nodiscard]] Result<void> refine(const DrawRequest& request, HostTime began) {
    glfwMakeContextCurrent(window.handle);
    core->activate();
    ImGui_ImplGlfw_NewFrame();
    ENAMEL_TRY(core->refine(request));
    if (core->refinable()) {
      glFinish();  // a part is over when it is drawn: else the last one would take the time of all
      pacer.drawn(began, clock.now());
      return {};
    }
    show(request.width, request.height);
    end_frame(began);
    return {};
  }

  void end_frame(HostTime began) {
    const HostTime ended = clock.now();
    pacer.drawn(began, ended);
    last_draw = began;
    ever_drawn = true;
    ++stats.frames_drawn;
    stats.last_shown = ended;
    stats.last_frame_ms = 1e3 * seconds(ended - began);
  }

  ViewerOptions options;
  Clock& clock;
  FramePacer pacer;
  DetailBudget detail;
  GlfwWindow window;  // outlives the core: GL names are released in its context
  WindowInput input;
  std::unique_ptr<ViewerCore> core;
  bool imgui_connected = false;
  std::shared_ptr<const PreviewFrame> shown;
  HostTime last_draw{}, last_change{};
  bool ever_drawn = false;
  ViewerStats stats;
};

ViewerWindow::ViewerWindow(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ViewerWindow::~ViewerWindow() = default;

Result<std::unique_ptr<ViewerWindow>> ViewerWindow::open(const ViewerOptions& options, Clock& clock) {
  auto impl = std::make_unique<Impl>(options, clock);
  ENAMEL_TRY(create(impl->window, options));
  glfwMakeContextCurrent(impl->window.handle);
  glfwSwapInterval(0);  // the cap comes from the pacer; swapping never blocks
  connect_input(impl->window.handle, impl->input);
  ENAMEL_TRY_ASSIGN(impl->core, ViewerCore::make(options));
  if (!impl->core->software()) {
    impl->detail = DetailBudget(options.frame_ms, DetailBudget::kMost);
  }
  impl->imgui_connected = ImGui_ImplGlfw_InitForOpenGL(impl->window.handle, true);
  return std::unique_ptr<ViewerWindow>(new ViewerWindow(std::move(impl)));
}

bool ViewerWindow::wait_frame() {
  constexpr Nanoseconds kLongest{50'000'000};
  const HostTime due = impl_->pacer.due(), events_due = impl_->clock.now() + kLongest;
  impl_->clock.sleep_until(std::min(due, events_due));
  return due <= events_due;
}

UserCommands ViewerWindow::poll() {
  Impl& me = *impl_;
  me.core->activate();
  glfwPollEvents();
  UserCommands commands;
  WindowInput& in = me.input;
  int width = 1;
  int height = 1;
  glfwGetWindowSize(me.window.handle, &width, &height);
  const double side = std::max(1, height);
  constexpr double kTurnPerHeight = 4.0;  // rad for a drag over the window's height
  if (in.left_dx != 0 || in.left_dy != 0) {
    me.core->drag_orbit(kTurnPerHeight * in.left_dx / side, kTurnPerHeight * in.left_dy / side);
  }
  if (in.right_dx != 0 || in.right_dy != 0) {
    me.core->drag_pan(in.right_dx / side, in.right_dy / side);
  }
  if (in.wheel != 0) {
    me.core->wheel(in.wheel);
  }
  for (const Action action : std::exchange(in.actions, {})) {
    switch (action) {
      case Action::kToggleScan:
        commands.toggle_scan = true;
        break;
      case Action::kSavePicture:
        commands.save_picture = true;
        break;
      case Action::kQuit:
        commands.quit = true;
        break;
      default:
        me.core->act(action);
    }
  }
  in.left_dx = in.left_dy = in.right_dx = in.right_dy = in.wheel = 0;
  commands.quit = commands.quit || glfwWindowShouldClose(me.window.handle) == GLFW_TRUE;
  commands.toggle_scan = me.core->take_scan_click() || commands.toggle_scan;
  return commands;
}

Result<void> ViewerWindow::render(std::shared_ptr<const PreviewFrame> frame) {
  constexpr double kIdleRedrawS = 0.5;
  constexpr double kRestS = 0.25;  // chosen: shorter pauses of a hand are no rest
  Impl& me = *impl_;
  const HostTime began = me.clock.now();
  const double since_s = seconds(began - me.last_draw);
  const bool same = !frame || frame == me.shown || (me.shown && same_picture(*frame, *me.shown));
  DrawRequest request;
  glfwGetFramebufferSize(me.window.handle, &request.width, &request.height);
  request.quality = me.core->software() ? Quality::kLive : Quality::kFine;
  request.upload_budget_bytes = me.options.upload_budget_bytes;
  request.triangle_budget = me.detail.triangles();
  request.sharpness = me.detail.sharpness();
  request.dt_s = me.ever_drawn ? since_s : 0;
  if (request.width <= 0 || request.height <= 0) {
    me.pacer.drawn(began, began);
    return {};
  }
  const bool rests = me.ever_drawn && same && !me.input.any && me.core->settled() && me.fits(request);
  if (!rests) {
    me.last_change = began;
  } else if (seconds(began - me.last_change) >= kRestS && me.core->refinable()) {
    return me.refine(request, began);
  } else if (since_s < kIdleRedrawS) {
    me.pacer.drawn(began, began);
    return {};
  }
  me.input.any = false;
  if (frame) {
    me.pacer.told(frame->counters.shed, began);
    me.shown = frame;
  }
  ENAMEL_TRY(me.draw(std::move(frame), request));
  me.show(request.width, request.height);
  me.end_frame(began);
  me.detail.drawn(me.stats.last_frame_ms, me.core->model().drawn_triangles());
  return {};
}

Result<Picture> ViewerWindow::screenshot() {
  DrawRequest request;
  glfwGetFramebufferSize(impl_->window.handle, &request.width, &request.height);
  request.quality = Quality::kFine;
  request.upload_budget_bytes = std::numeric_limits<std::size_t>::max();
  request.interactive = false;
  if (request.width <= 0 || request.height <= 0) {
    return fail(ErrorCode::kDisplay, "the window is minimised: there is nothing to save");
  }
  ENAMEL_TRY(impl_->draw(impl_->shown, request));
  Picture picture = impl_->core->read_picture();
  picture.drawn_by = "window (OpenGL " + impl_->core->description() + ")";
  return picture;
}

void ViewerWindow::set_field(const ProbeField& field) { impl_->core->set_field(field); }

DisplayToggles& ViewerWindow::toggles() { return impl_->core->toggles(); }

ViewerStats ViewerWindow::stats() const {
  ViewerStats out = impl_->stats;
  const ModelPass& model = impl_->core->model();
  out.bytes_uploaded = model.uploaded_bytes();
  out.blocks_pending = model.pending();
  out.triangles = model.triangles();
  out.draw_calls = model.draw_calls();
  out.drawn_triangles = model.drawn_triangles();
  out.triangle_budget = impl_->detail.triangles();
  out.sharpness = impl_->detail.sharpness();
  out.refined = !impl_->core->refinable();
  return out;
}

std::string ViewerWindow::gl_description() const { return impl_->core->description(); }

}  // namespace enamel::view
