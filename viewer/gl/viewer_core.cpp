#include "viewer/gl/viewer_core.hpp"

#include <backends/imgui_impl_opengl3.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace enamel::view {
namespace {

constexpr double kReturnShare = 0.2;  // of the picture's width

std::string gl_string(GLenum name) {
  const GLubyte* text = glGetString(name);
  return text != nullptr ? reinterpret_cast<const char*>(text) : "";
}

bool is_software(const std::string& renderer) {
  return renderer.find("llvmpipe") != std::string::npos || renderer.find("softpipe") != std::string::npos ||
         renderer.find("SWR") != std::string::npos;
}

}  // namespace

ViewerCore::ViewerCore(const ViewerOptions& options)
    : field_(options.field),
      toggles_(options.toggles),
      follow_(follow_config_),
      scale_(static_cast<float>(std::clamp(options.ui_scale, 0.5, 2.0))),
      wanted_scale_(scale_) {
  camera_ = follow_goal(Pose::Identity(), std::nan(""), field_, follow_config_);
}

Result<std::unique_ptr<ViewerCore>> ViewerCore::make(const ViewerOptions& options) {
  if (epoxy_gl_version() < 33) {
    return fail(ErrorCode::kDisplay, "OpenGL " + gl_string(GL_VERSION) + " is older than 3.3");
  }
  std::unique_ptr<ViewerCore> core(new ViewerCore(options));
  const std::string renderer = gl_string(GL_RENDERER);
  core->software_ = is_software(renderer);
  core->description_ = gl_string(GL_VERSION) + ", " + renderer;
  ENAMEL_TRY_ASSIGN(core->scene_, SceneRenderer::make());
  IMGUI_CHECKVERSION();
  core->imgui_ = ImGui::CreateContext();
  core->activate();
  ImGui::GetIO().IniFilename = nullptr;
  ImGui::GetIO().LogFilename = nullptr;
  core->imgui_gl_ = ImGui_ImplOpenGL3_Init("#version 330 core");
  if (!core->imgui_gl_) {
    return fail(ErrorCode::kDisplay, "the panels' OpenGL functions cannot be loaded (libGL.so.1)");
  }
  core->fonts_ = load_fonts(core->scale_);
  apply_style(core->scale_);
  return core;
}

ViewerCore::~ViewerCore() {
  if (imgui_ != nullptr) {
    activate();
    if (imgui_gl_) {
      ImGui_ImplOpenGL3_Shutdown();
    }
    ImGui::DestroyContext(imgui_);
  }
}

void ViewerCore::rescale_text(float scale) {
  if (scale != scale_) {
    scale_ = scale;
    fonts_ = load_fonts(scale);
    apply_style(scale);
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    ImGui_ImplOpenGL3_CreateFontsTexture();
  }
}

Result<void> ViewerCore::draw(std::shared_ptr<const PreviewFrame> frame, const DrawRequest& request) {
  activate();
  frame_ = frame ? std::move(frame) : frame_;
  if (!frame_) {
    frame_ = std::make_shared<PreviewFrame>();
  }
  if (!out_ || out_->width() != request.width || out_->height() != request.height) {
    out_.reset();
    drawn_.reset();
    ENAMEL_TRY_ASSIGN(out_, RenderTarget::make(request.width, request.height, false));
  }
  const PreviewFrame& now = *frame_;
  static const ModelSnapshot kNothing;
  scene_->model().set_tone(now.segment == kModelSegment ? kTooth : kApartTooth);
  scene_->model().update(now.model ? *now.model : kNothing, request.upload_budget_bytes);
  ENAMEL_TRY(return_.update(now, {static_cast<int>(kReturnShare * request.width), toggles_, field_, scale_}));
  move_camera(now, static_cast<double>(request.width) / request.height, request.dt_s);
  send_live_image(now);

  Drawn next{scene_view(now, request), request.quality, scene_->model().revision(), now.segment};
  const bool same = drawn_ && drawn_->quality == next.quality && drawn_->revision == next.revision &&
                    drawn_->segment == next.segment && same_view(drawn_->view, next.view);
  if (same) {
    scene_->compose_again(*out_);
  } else {
    drawn_.reset();
    ENAMEL_TRY(scene_->draw(next.view, request.quality, *out_));
    drawn_ = std::move(next);
  }
  draw_panels(now, request);
  return {};
}

Result<void> ViewerCore::refine(const DrawRequest& request) {
  activate();
  drawn_->view.triangle_budget = request.triangle_budget;
  ENAMEL_TRY(scene_->refine(drawn_->view, *out_));
  if (scene_->finished()) {
    draw_panels(*frame_, request);
  }
  return {};
}

SceneView ViewerCore::scene_view(const PreviewFrame& frame, const DrawRequest& request) const {
  SceneView view;
  view.camera = camera_;
  view.toggles = toggles_;
  view.field = field_;
  view.probe_colour = status_line(frame).colour;
  if (frame.segment == kModelSegment) {
    view.trail = frame.trail;
  }
  view.line_scale = scale_;
  view.triangle_budget = request.triangle_budget;
  view.sharpness = request.sharpness;
  if (frame.placed) {
    view.T_model_cam = frame.T_model_cam;
    view.focus = field_ball(field_, frame.T_model_cam);
  }
  return view;
}

void ViewerCore::draw_panels(const PreviewFrame& frame, const DrawRequest& request) {
  rescale_text(wanted_scale_);
  shown_toggles_ = toggles_;
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = ImVec2(static_cast<float>(request.width), static_cast<float>(request.height));
  io.DisplayFramebufferScale = ImVec2(1, 1);
  if (!(io.DeltaTime > 0)) {
    io.DeltaTime = 1.0F / 60;
  }
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
  OverlayInput input;
  input.frame = &frame;
  input.toggles = toggles_;
  input.status = status_line(frame);
  input.distance = distance_reading(frame.surface_distance_mm, field_);
  input.triangles = scene_->model().triangles();
  input.interactive = request.interactive;
  input.scale = scale_;
  input.width_px = io.DisplaySize.x;
  input.height_px = io.DisplaySize.y;
  if (live_source_) {
    input.live_texture = live_.id();
    input.live_width = live_source_->width();
    input.live_height = live_source_->height();
  }
  if (const RenderTarget* const picture = return_.get()) {
    input.return_texture = picture->colour();
    input.return_width = picture->width();
    input.return_height = picture->height();
  }
  scan_clicked_ = draw_overlay(input, fonts_) || scan_clicked_;
  ImGui::Render();
  out_->bind();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

std::optional<ViewCamera> ViewerCore::camera_goal(const PreviewFrame& frame, double aspect) {
  if ((frame.state == ScanState::kFinished || recentre_) && frame.model) {
    if (overview_of_ != frame.model) {
      overview_of_ = frame.model;
      overview_ = overview(*frame.model, aspect);
    }
    if (overview_) {
      return overview_;
    }
  }
  const bool lost = frame.track == TrackState::kLost && frame.state == ScanState::kScanning;
  if (!frame.placed || (lost && !follow_.fresh())) {
    return std::nullopt;  // nobody knows where the probe is: the view rests
  }
  return follow_goal(frame.T_model_cam, frame.surface_distance_mm, field_, follow_config_);
}

void ViewerCore::move_camera(const PreviewFrame& frame, double aspect, double dt_s) {
  if (!toggles_.follow && !recentre_) {
    return;
  }
  if (const auto goal = camera_goal(frame, aspect)) {
    if (recentre_ || frame.segment != followed_) {  // another frame of reference: nothing to glide over
      camera_ = *goal;
    } else {
      camera_ = follow_.step(camera_, *goal, dt_s);
    }
  }
  recentre_ = false;
  followed_ = frame.segment;
}

void ViewerCore::send_live_image(const PreviewFrame& frame) {
  if (frame.live == live_source_) {
    return;
  }
  live_source_ = frame.live;
  GLint largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (!live_source_ || live_source_->empty() || live_source_->width() > largest || live_source_->height() > largest) {
    live_source_.reset();
    return;
  }
  if (!live_) {
    live_ = GlTexture::make();
  }
  glBindTexture(GL_TEXTURE_2D, live_.id());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, live_source_->width(), live_source_->height(), 0, GL_RED, GL_UNSIGNED_BYTE,
               live_source_->pixels().data());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  constexpr std::array<GLint, 4> kGrey{GL_RED, GL_RED, GL_RED, GL_ONE};
  glTexParameteriv(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_RGBA, kGrey.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glGenerateMipmap(GL_TEXTURE_2D);
}

void ViewerCore::act(Action action) {
  constexpr float kStep = 0.125F;
  switch (action) {
    case Action::kRecentre:
      recentre_ = true;
      toggles_.follow = false;
      return;
    case Action::kLargerText:
      wanted_scale_ = std::min(wanted_scale_ + kStep, 2.0F);
      return;
    case Action::kSmallerText:
      wanted_scale_ = std::max(wanted_scale_ - kStep, 0.5F);
      return;
    default:
      apply_toggle(action, toggles_);
  }
}

void ViewerCore::drag_orbit(double right_rad, double down_rad) {
  toggles_.follow = false;  // the person took the view over; F gives it back
  orbit(camera_, right_rad, down_rad);
}

void ViewerCore::drag_pan(double right, double down) {
  toggles_.follow = false;
  pan(camera_, right, down);
}

void ViewerCore::wheel(double steps) {
  const double factor = std::pow(1.12, std::clamp(steps, -20.0, 20.0));
  if (toggles_.follow) {
    follow_config_.height_mm = std::clamp(follow_config_.height_mm / factor, 10.0, 160.0);
  }
  zoom(camera_, factor);
}

bool ViewerCore::settled() const {
  return !follow_.moving() && !recentre_ && scene_->model().pending() == 0 && wanted_scale_ == scale_ &&
         shown_toggles_ == toggles_;
}

Picture ViewerCore::read_picture() const {
  Picture picture;
  picture.width = out_->width();
  picture.height = out_->height();
  const std::size_t stride = static_cast<std::size_t>(picture.width) * 3;
  std::vector<std::uint8_t> bottom_up(stride * static_cast<std::size_t>(picture.height));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, out_->framebuffer());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, picture.width, picture.height, GL_RGB, GL_UNSIGNED_BYTE, bottom_up.data());
  picture.rgb.resize(bottom_up.size());
  for (std::size_t row = 0; row < static_cast<std::size_t>(picture.height); ++row) {
    const std::size_t from = (static_cast<std::size_t>(picture.height) - 1 - row) * stride;
    std::copy_n(bottom_up.begin() + static_cast<std::ptrdiff_t>(from), stride,
                picture.rgb.begin() + static_cast<std::ptrdiff_t>(row * stride));
  }
  return picture;
}

}  // namespace enamel::view
