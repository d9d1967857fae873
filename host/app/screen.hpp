// The host's screen: turns what session and pipeline publish into the viewer's frames, in a window or without any
// display.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "calib/model/rig.hpp"
#include "pipeline/stages/preview_item.hpp"
#include "pipeline/types/mesh.hpp"
#include "protocol/base/clock.hpp"
#include "protocol/base/result.hpp"
#include "viewer/gl/viewer_window.hpp"
#include "viewer/scene/preview.hpp"

namespace enamel::app {

/// Main thread only.
class Screen {
 public:
  /// A screen without a window. open_window() may follow.
  Screen(std::string title, Clock& clock);
  /// Errors: kDisplay.
  [[nodiscard]] Result<void> open_window();
  [[nodiscard]] bool has_window() const noexcept { return window_ != nullptr; }

  void set_field(const calib::Rig& rig);

  struct State {
    view::ScanState scan = view::ScanState::kWaitingForProbe;
    view::PreviewCounters counters;
    std::string message;
    bool simulated = false;
    double rate_hz = 0;
    double latency_ms = 0;
  };
  /// Draws the newest item (or the one before when `item` is null) and handles the keyboard.
  view::UserCommands refresh(const State& state, const std::shared_ptr<const stage::PreviewItem>& item);

  /// Last picture, of the finished model when given, to a PNG. Returns which path drew it. Errors: kDisplay,
  /// kFileWrite.
  [[nodiscard]] Result<std::string> write_picture(const State& state, const Mesh* finished, const std::string& path);

 private:
  [[nodiscard]] std::shared_ptr<const view::PreviewFrame> frame(const State& state) const;

  view::ViewerOptions options_;
  Clock& clock_;
  std::unique_ptr<view::ViewerWindow> window_;
  std::shared_ptr<const stage::PreviewItem> last_;
  std::shared_ptr<std::vector<Vec3f>> trail_;
};

}  // namespace enamel::app
