// The panels over the picture: state, figures, stages, live image with distance bar, message, legend, help.
#pragma once

#include <epoxy/gl.h>

#include <cstddef>

#include "pipeline/types/preview.hpp"
#include "viewer/gl/ui_style.hpp"
#include "viewer/scene/status.hpp"
#include "viewer/scene/toggles.hpp"

namespace enamel::view {

struct OverlayInput {
  const PreviewFrame* frame = nullptr;  ///< never null when drawing
  DisplayToggles toggles;
  StatusLine status;
  DistanceReading distance;
  std::size_t triangles = 0;
  bool interactive = true;  ///< a button for scan/pause; a picture for a file has none
  float scale = 1;
  float width_px = 0;
  float height_px = 0;
  GLuint live_texture = 0;
  int live_width = 0;
  int live_height = 0;
  GLuint return_texture = 0;  ///< picture of the model and the place in it to return to, or none
  int return_width = 0;
  int return_height = 0;
};

/// Between ImGui::NewFrame and ImGui::Render. True: the scan/pause button was pressed.
[[nodiscard]] bool draw_overlay(const OverlayInput& input, const Fonts& fonts);

/// Parts of it.
void draw_live_corner(const OverlayInput& input, const Pen& pen);
/// Needs return_texture.
void draw_return_corner(const OverlayInput& input, const Pen& pen);
/// Needs frame->pipeline.
void draw_stages(const OverlayInput& input, const Pen& pen, ImVec2 top_right);
void draw_legend(const OverlayInput& input, const Pen& pen, ImVec2 bottom_right);
/// Says that stripes are soft tissue, or that it is hidden; nothing where the model has none.
void draw_soft_legend(const OverlayInput& input, const Pen& pen, ImVec2 bottom_right);
void draw_help(const OverlayInput& input, const Pen& pen);

}  // namespace enamel::view
