// The host's screen, in a window or without any display: puts the newest burst and the path so far to what a session
// says of itself.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "calib/model/rig.hpp"
#include "pipeline/types/mesh.hpp"
#include "pipeline/types/preview.hpp"
#include "protocol/base/clock.hpp"
#include "protocol/base/result.hpp"
#include "viewer/gl/viewer_window.hpp"
#include "viewer/scene/trail.hpp"

namespace enamel::app {

/// Main thread only.
class Screen {
 public:
  /// A screen without a window. open_window() may follow.
  Screen(std::string title, Clock& clock);
  /// Whether a window could be opened, by opening one that is not shown. Errors: kDisplay.
  [[nodiscard]] static Result<void> try_display(Clock& clock);
  /// Errors: kDisplay.
  [[nodiscard]] Result<void> open_window();
  [[nodiscard]] bool has_window() const noexcept { return window_ != nullptr; }

  void set_field(const calib::Rig& rig);

  /// The newest burst; null: none since the last call.
  void add(std::shared_ptr<const BurstPreview> burst);
  /// Draws the newest burst and handles the keyboard. Without a window: nothing to do, nothing wanted.
  view::UserCommands draw(PreviewFrame session);
  /// The burst that the last draw() was the first to show and since when, once.
  struct Shown {
    BurstId burst;
    HostTime at;
  };
  [[nodiscard]] std::optional<Shown> take_shown() { return std::exchange(shown_, std::nullopt); }
  /// Last picture, of the finished mesh, to a PNG. Returns which path drew it. Errors: kDisplay, kFileWrite.
  [[nodiscard]] Result<std::string> write_picture(PreviewFrame session, const Mesh& mesh, const std::string& path);

 private:
  [[nodiscard]] std::shared_ptr<PreviewFrame> frame(PreviewFrame session) const;

  view::ViewerOptions options_;
  Clock& clock_;
  std::unique_ptr<view::ViewerWindow> window_;
  std::shared_ptr<const BurstPreview> newest_;
  bool newest_shown_ = true;
  std::optional<Shown> shown_;
  view::Trail trail_;
};

}  // namespace enamel::app
