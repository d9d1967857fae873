// Fonts, panel colours and small drawing helpers of the overlay.
#pragma once

#include <imgui.h>

#include <string_view>

#include "viewer/scene/colour.hpp"

namespace enamel::view {

inline constexpr Colour kPanel{0.070F, 0.080F, 0.096F};
inline constexpr Colour kText{0.93F, 0.95F, 0.97F};
inline constexpr Colour kTextDim{0.66F, 0.71F, 0.77F};

struct Fonts {
  ImFont* small = nullptr;
  ImFont* body = nullptr;
  ImFont* title = nullptr;
  ImFont* big = nullptr;
};

/// Loads Inter or DejaVu Sans from the system; ImGui's own bitmap font when neither is there. Builds the atlas of the
/// current ImGui context.
[[nodiscard]] Fonts load_fonts(float scale);

void apply_style(float scale);

[[nodiscard]] inline ImU32 packed(const Colour& c, float alpha = 1) {
  return ImGui::ColorConvertFloat4ToU32(ImVec4(c.r, c.g, c.b, alpha));
}

/// Draws into one draw list with sizes in units of the text scale.
struct Pen {
  ImDrawList* list;
  const Fonts* fonts;
  float scale;

  [[nodiscard]] float px(float units) const { return units * scale; }
  [[nodiscard]] ImVec2 size(const ImFont* font, std::string_view text, float wrap_px = 0) const;
  void text(ImVec2 at, const ImFont* font, const Colour& colour, std::string_view words, float wrap_px = 0) const;
  void text_right(ImVec2 top_right, const ImFont* font, const Colour& colour, std::string_view words) const;
  void panel(ImVec2 from, ImVec2 to, float alpha = 0.80F) const;
};

}  // namespace enamel::view
