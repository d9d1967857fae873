// How the viewer looks; shared by the window and by pictures drawn without a display.
#pragma once

#include <cstddef>
#include <string>

#include "viewer/scene/detail.hpp"
#include "viewer/scene/probe_field.hpp"
#include "viewer/scene/toggles.hpp"

namespace enamel::view {

struct ViewerOptions {
  std::string title = "enamel";
  int width = 1280;
  int height = 800;
  bool visible = true;
  double max_fps = 20;  ///< software rendering shares the cores with the pipeline
  /// Of one thread: after a frame that took t, the next starts t / share later at the earliest. chosen: a frame within
  /// its frame_ms comes twelve times a second and leaves two cores three quarters of their time.
  double max_busy_share = 0.25;
  double yielding_share = 0.2;  ///< the same while bursts are shed: four or more frames a second
  double frame_ms = 20;  ///< that a frame may take: what is too much for that is drawn coarser while the view moves
  std::size_t triangle_budget = DetailBudget::kSoftwareStart;  ///< of the first frames, when drawn in software
  double ui_scale = 1.0;                                       ///< 1.0 … 2.0
  std::size_t upload_budget_bytes = std::size_t{4} << 20;  ///< mesh data sent to the GPU per frame; the rest follows
  ProbeField field;
  DisplayToggles toggles;
};

}  // namespace enamel::view
