// How the viewer looks; shared by the window and by pictures drawn without a display.
#pragma once

#include <cstddef>
#include <string>

#include "viewer/scene/probe_field.hpp"

namespace enamel::view {

struct DisplayToggles {
  bool quality_map = false;  ///< Q
  bool mono = false;         ///< M: matte grey light instead of tooth colour
  bool follow = true;        ///< F
  bool frustum = true;       ///< P
  bool trail = true;         ///< T
  bool live_image = true;    ///< I
  bool help = false;         ///< F1
  bool overlay = true;       ///< O: panels; the outline and its words always stay
};

struct ViewerOptions {
  std::string title = "enamel";
  int width = 1280;
  int height = 800;
  bool visible = true;
  double max_fps = 20;           ///< software rendering shares the cores with the pipeline
  double max_busy_share = 0.4;   ///< of one thread: after a frame that took t, the next starts t / share later at the earliest
  double ui_scale = 1.0;         ///< 1.0 … 2.0
  std::size_t upload_budget_bytes = std::size_t{4} << 20;  ///< mesh data sent to the GPU per frame; the rest follows
  ProbeField field;
  DisplayToggles toggles;
};

}  // namespace enamel::view
