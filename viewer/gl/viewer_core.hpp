// What the window and the offscreen picture share: everything between a PreviewFrame and finished pixels. Needs a
// current OpenGL >= 3.3 context on the calling thread for its whole life, and no other ImGui context in use during a
// call.
#pragma once

#include <imgui.h>

#include <memory>
#include <optional>
#include <string>

#include "pipeline/types/preview.hpp"
#include "protocol/base/result.hpp"
#include "viewer/gl/overlay.hpp"
#include "viewer/gl/picture.hpp"
#include "viewer/gl/return_picture.hpp"
#include "viewer/gl/scene_renderer.hpp"
#include "viewer/gl/viewer_options.hpp"
#include "viewer/scene/follow_camera.hpp"
#include "viewer/scene/keys.hpp"

namespace enamel::view {

struct DrawRequest {
  int width = 0;
  int height = 0;
  Quality quality = Quality::kLive;
  std::size_t upload_budget_bytes = 0;
  std::size_t triangle_budget = ~std::size_t{0};
  double sharpness = 1;  ///< as SceneView's
  bool interactive = true;
  double dt_s = 0;  ///< since the previous draw, for the camera's motion
};

class ViewerCore {
 public:
  [[nodiscard]] static Result<std::unique_ptr<ViewerCore>> make(const ViewerOptions& options);
  ~ViewerCore();
  ViewerCore(const ViewerCore&) = delete;
  ViewerCore& operator=(const ViewerCore&) = delete;

  void activate() const { ImGui::SetCurrentContext(imgui_); }

  /// Draws into picture_target(), the 3-D part only where it is another than last time. Errors: kDisplay.
  [[nodiscard]] Result<void> draw(std::shared_ptr<const PreviewFrame> frame, const DrawRequest& request);
  /// One more part of the picture that the last view gets while it rests; picture_target() changes with the last part
  /// alone. Errors: kDisplay.
  [[nodiscard]] Result<void> refine(const DrawRequest& request);
  /// The last view can be drawn finer than it was.
  [[nodiscard]] bool refinable() const { return drawn_ && drawn_->quality == Quality::kLive && !scene_->finished(); }
  [[nodiscard]] const RenderTarget& picture_target() const { return *out_; }
  [[nodiscard]] Picture read_picture() const;

  void set_field(const ProbeField& field) { field_ = field; }
  void act(Action action);
  void drag_orbit(double right_rad, double down_rad);
  void drag_pan(double right, double down);
  void wheel(double steps);

  [[nodiscard]] bool take_scan_click() { return std::exchange(scan_clicked_, false); }
  [[nodiscard]] bool settled() const;  ///< the next picture of the same frame would look the same
  [[nodiscard]] DisplayToggles& toggles() noexcept { return toggles_; }
  [[nodiscard]] ModelPass& model() noexcept { return scene_->model(); }
  [[nodiscard]] bool software() const noexcept { return software_; }
  [[nodiscard]] const std::string& description() const noexcept { return description_; }

 private:
  explicit ViewerCore(const ViewerOptions& options);
  void move_camera(const PreviewFrame& frame, double aspect, double dt_s);
  [[nodiscard]] std::optional<ViewCamera> camera_goal(const PreviewFrame& frame, double aspect);
  [[nodiscard]] SceneView scene_view(const PreviewFrame& frame, const DrawRequest& request) const;
  void send_live_image(const PreviewFrame& frame);
  void draw_panels(const PreviewFrame& frame, const DrawRequest& request);
  void rescale_text(float scale);

  ProbeField field_;
  DisplayToggles toggles_, shown_toggles_;
  FollowConfig follow_config_;
  FollowCamera follow_;
  ViewCamera camera_;
  float scale_;
  float wanted_scale_;
  Fonts fonts_;
  ImGuiContext* imgui_ = nullptr;
  bool imgui_gl_ = false;
  std::unique_ptr<SceneRenderer> scene_;
  std::optional<RenderTarget> out_;
  ReturnPicture return_;
  SegmentId followed_ = kModelSegment;  ///< in whose frame the camera is
  GlTexture live_;
  std::shared_ptr<const Map<std::uint8_t>> live_source_;
  std::shared_ptr<const ModelSnapshot> overview_of_;
  std::optional<ViewCamera> overview_;
  std::shared_ptr<const PreviewFrame> frame_;
  struct Drawn {
    SceneView view;
    Quality quality = Quality::kLive;
    std::uint64_t revision = 0;  ///< of the model
    SegmentId segment = kModelSegment;
  };
  std::optional<Drawn> drawn_;  ///< 3-D part of out_
  bool recentre_ = false;
  bool scan_clicked_ = false;
  bool software_ = true;
  std::string description_;
};

}  // namespace enamel::view
