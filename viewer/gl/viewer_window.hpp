// The live window. One thread owns it (the program's main thread: GLFW demands that); the caller owns the loop:
//
//   while (!quit) {
//     const bool is_due = window->wait_frame();   // sleeps until the next frame is due, never longer than 50 ms
//     const UserCommands c = window->poll();      // keys, mouse, close button
//     if (is_due) window->render(mailbox.take_or_last());  // draws the newest frame; never waits for the pipeline
//   }
//
// Not thread-safe. Nothing here waits for the pipeline: frames come from a LatestSlot and are immutable.
#pragma once

#include <memory>
#include <string>

#include "pipeline/types/preview.hpp"
#include "protocol/base/clock.hpp"
#include "protocol/base/result.hpp"
#include "viewer/gl/picture.hpp"
#include "viewer/gl/viewer_options.hpp"

namespace enamel::view {

struct UserCommands {
  bool quit = false;          ///< close button or Ctrl-Q
  bool toggle_scan = false;   ///< Space or the button: scan/pause
  bool save_picture = false;  ///< F12: the caller chooses the file and calls screenshot()
};

struct ViewerStats {
  std::uint64_t frames_drawn = 0;
  std::uint64_t bytes_uploaded = 0;  ///< mesh data since the window opened
  std::size_t blocks_pending = 0;    ///< changed blocks that wait for the next frames' upload budget
  std::size_t triangles = 0;         ///< of the model as far as it was sent
  std::size_t drawn_triangles = 0;   ///< in the last frame, or the last part of a picture that rests
  std::size_t triangle_budget = 0;   ///< of the next frame
  double sharpness = 1;              ///< of the next frame: DetailBudget::sharpness()
  bool refined = false;              ///< the view rests: its picture is of the mesh as it is
  int draw_calls = 0;                ///< of the model in the last frame
  double last_frame_ms = 0;
  HostTime last_shown{};  ///< when the last frame was handed to the display; the epoch before the first
};

class ViewerWindow {
 public:
  /// Errors: kDisplay (no X server, no OpenGL >= 3.3) with what was tried in the detail.
  [[nodiscard]] static Result<std::unique_ptr<ViewerWindow>> open(const ViewerOptions& options, Clock& clock);
  ~ViewerWindow();
  ViewerWindow(const ViewerWindow&) = delete;
  ViewerWindow& operator=(const ViewerWindow&) = delete;

  /// Sleeps on the injected clock until the next frame is due (frame-rate cap and busy share), at most 50 ms. False:
  /// it is not due yet, only events are.
  [[nodiscard]] bool wait_frame();

  /// Handles events; what the person asked for since the last call.
  [[nodiscard]] UserCommands poll();

  /// Draws and shows `frame`. A null pointer draws the previous one again (empty scene before the first). Skips the
  /// work when nothing would change. Errors: kDisplay when the driver refuses a buffer (the window stays usable).
  Result<void> render(std::shared_ptr<const PreviewFrame> frame);

  /// The last frame drawn anew at twice the resolution and scaled down (smooth edges), mesh complete, without the
  /// budget.
  [[nodiscard]] Result<Picture> screenshot();

  /// The probe's field, once it is known.
  void set_field(const ProbeField& field);
  [[nodiscard]] DisplayToggles& toggles();
  [[nodiscard]] ViewerStats stats() const;
  [[nodiscard]] std::string gl_description() const;  ///< "4.5 (Core Profile) Mesa …, llvmpipe …"

 private:
  struct Impl;
  explicit ViewerWindow(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace enamel::view
