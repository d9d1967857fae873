// Live image with distance bar, legend of the quality map, key help.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <string>

#include "viewer/gl/overlay.hpp"
#include "viewer/scene/keys.hpp"

namespace enamel::view {
namespace {

constexpr float kMargin = 20;

ImTextureID texture_id(GLuint texture) {
  // ImGui's GL backend carries a texture's name in a pointer. NOLINTNEXTLINE(performance-no-int-to-ptr)
  return reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(texture));
}

void draw_marker(const Pen& pen, float x, float y, const DistanceReading& reading) {
  const float s = pen.px(8);
  pen.list->AddTriangleFilled(ImVec2(x, y), ImVec2(x + s, y - s * 0.8F), ImVec2(x + s, y + s * 0.8F),
                              packed(reading.colour));
  const float cx = x + s + pen.px(10);
  if (reading.icon == "o") {
    pen.list->AddCircle(ImVec2(cx, y), pen.px(5), packed(reading.colour), 24, pen.px(2.2F));
    return;
  }
  const float tip = reading.icon == "^" ? -1.0F : 1.0F;
  pen.list->AddTriangleFilled(ImVec2(cx, y + tip * pen.px(6)), ImVec2(cx - pen.px(6), y - tip * pen.px(4)),
                              ImVec2(cx + pen.px(6), y - tip * pen.px(4)), packed(reading.colour));
}

/// Vertical bar: top = near the teeth's end of the field (move away), bottom = far.
void draw_distance_bar(const OverlayInput& in, const Pen& pen, ImVec2 from, float height) {
  const DistanceReading& d = in.distance;
  const float width = pen.px(12);
  const auto at = [&](double share) { return from.y + height * static_cast<float>(share); };
  constexpr double kNearEnd = 1.0 / 6;  // the field's near and far ends on the bar
  constexpr double kFarEnd = 5.0 / 6;
  const auto part = [&](double a, double b, const Colour& colour, float alpha) {
    pen.list->AddRectFilled(ImVec2(from.x, at(a)), ImVec2(from.x + width, at(b)), packed(colour, alpha), pen.px(2));
  };
  part(0, kNearEnd, kBad, 0.85F);
  part(kNearEnd, d.optimum_from, kWeak, 0.65F);
  part(d.optimum_from, d.optimum_to, kGood, 1.0F);
  part(d.optimum_to, kFarEnd, kAccent, 0.6F);
  part(kFarEnd, 1, kViolet, 0.85F);
  if (d.zone != DistanceZone::kNone) {
    draw_marker(pen, from.x + width + pen.px(3), at(d.position), d);
  }
}

std::string distance_words(const OverlayInput& in) {
  std::string words(in.distance.words);
  if (in.distance.zone != DistanceZone::kNone) {
    std::array<char, 24> mm{};
    std::snprintf(mm.data(), mm.size(), "   %.1f mm", in.frame->surface_distance_mm);
    words += mm.data();
  }
  return words;
}

/// A ring where glare or metal is, in the live picture, with its name.
void draw_trouble(const OverlayInput& in, const Pen& pen, ImVec2 from, ImVec2 to) {
  const Sight& sight = in.frame->sight;
  const bool has_place = sight.trouble == SightTrouble::kGlare || sight.trouble == SightTrouble::kMetal;
  if (!has_place || in.frame->track == TrackState::kLost) return;
  const ImVec2 at(from.x + (to.x - from.x) * sight.x_px / static_cast<float>(in.live_width),
                  from.y + (to.y - from.y) * sight.y_px / static_cast<float>(in.live_height));
  pen.list->AddCircle(at, pen.px(17), packed({0, 0, 0}, 0.7F), 32, pen.px(5));
  pen.list->AddCircle(at, pen.px(17), packed(kWeak), 32, pen.px(2.2F));
  const std::string_view name = name_of(sight.trouble);
  const ImVec2 size = pen.size(pen.fonts->small, name);
  const float x = std::clamp(at.x - size.x / 2, from.x, to.x - size.x);
  const bool above = at.y + pen.px(20) + size.y > to.y;
  pen.text(ImVec2(x, above ? at.y - pen.px(20) - size.y : at.y + pen.px(20)), pen.fonts->small, kText, name);
}

}  // namespace

void draw_live_corner(const OverlayInput& in, const Pen& pen) {
  const bool has_image = in.live_texture != 0 && in.live_width > 0 && in.live_height > 0;
  const float image_aspect =
      has_image ? static_cast<float>(in.live_width) / static_cast<float>(in.live_height) : 4.0F / 3.0F;
  const float width = std::min(pen.px(264), in.width_px * 0.26F);
  const float height = std::min(width / image_aspect, in.height_px * 0.4F);
  const float line = pen.px(30);
  const ImVec2 panel_to(pen.px(kMargin) + width + pen.px(66), in.height_px - pen.px(kMargin));
  const ImVec2 panel_from(pen.px(kMargin), panel_to.y - height - line - pen.px(22));
  pen.panel(panel_from, panel_to, 0.84F);
  const ImVec2 from(panel_from.x + pen.px(12), panel_from.y + pen.px(12));
  const ImVec2 to(from.x + width, from.y + height);
  if (has_image) {
    pen.list->AddImageRounded(texture_id(in.live_texture), from, to, ImVec2(0, 0), ImVec2(1, 1), IM_COL32_WHITE,
                              pen.px(6));
    draw_trouble(in, pen, from, to);
  } else {
    pen.list->AddRectFilled(from, to, packed({0.03F, 0.035F, 0.045F}), pen.px(6));
    const ImVec2 words = pen.size(pen.fonts->small, "No live image");
    pen.text(ImVec2((from.x + to.x - words.x) / 2, (from.y + to.y - words.y) / 2), pen.fonts->small, kTextDim,
             "No live image");
  }
  pen.list->AddRect(from, to, packed(in.status.colour), pen.px(6), 0, pen.px(3));
  draw_distance_bar(in, pen, ImVec2(to.x + pen.px(12), from.y), height);
  pen.text(ImVec2(from.x + pen.px(1), to.y + pen.px(9)), pen.fonts->body, in.distance.colour, distance_words(in));
}

void draw_return_corner(const OverlayInput& in, const Pen& pen) {
  const float width = static_cast<float>(in.return_width);
  const float height = static_cast<float>(in.return_height);
  const ImVec2 panel_from(pen.px(kMargin), pen.px(kMargin + 46));
  const ImVec2 from(panel_from.x + pen.px(12), panel_from.y + pen.px(12));
  const ImVec2 to(from.x + width, from.y + height);
  pen.panel(panel_from, ImVec2(to.x + pen.px(12), to.y + pen.px(42)), 0.84F);
  // OpenGL's rows begin at the bottom.
  pen.list->AddImageRounded(texture_id(in.return_texture), from, to, ImVec2(0, 1), ImVec2(1, 0), IM_COL32_WHITE,
                            pen.px(6));
  pen.text(ImVec2(from.x + pen.px(1), to.y + pen.px(9)), pen.fonts->body, kText, "The model: return here");
}

void draw_legend(const OverlayInput& in, const Pen& pen, ImVec2 bottom_right) {
  static_cast<void>(in);
  const float width = pen.px(214);
  const float height = pen.px(72);
  const ImVec2 from(bottom_right.x - width, bottom_right.y - height);
  pen.panel(from, bottom_right);
  const float left = from.x + pen.px(16);
  const float right = bottom_right.x - pen.px(16);
  const float middle = (left + right) / 2;
  pen.text(ImVec2(left, from.y + pen.px(8)), pen.fonts->small, kText, "Quality of the surface");
  const float top = from.y + pen.px(30);
  const float bottom = top + pen.px(12);
  const auto ramp = [&](float a, float b, const Colour& ca, const Colour& cb) {
    pen.list->AddRectFilledMultiColor(ImVec2(a, top), ImVec2(b, bottom), packed(ca), packed(cb), packed(cb),
                                      packed(ca));
  };
  ramp(left, middle, kQualityRamp[0], kQualityRamp[1]);
  ramp(middle, right, kQualityRamp[1], kQualityRamp[2]);
  pen.text(ImVec2(left, bottom + pen.px(5)), pen.fonts->small, kTextDim, "scan again");
  pen.text_right(ImVec2(right, bottom + pen.px(5)), pen.fonts->small, kTextDim, "well covered");
}

void draw_soft_legend(const OverlayInput& in, const Pen& pen, ImVec2 bottom_right) {
  const auto& model = in.frame->model;
  if (!model || std::ranges::none_of(model->blocks, [](const auto& b) { return b && !b->soft.empty(); })) return;
  if (in.toggles.quality_map) bottom_right.y -= pen.px(72 + 8);
  const ImVec2 from(bottom_right.x - pen.px(214), bottom_right.y - pen.px(58));
  pen.panel(from, bottom_right);
  const float left = from.x + pen.px(16);
  pen.text(ImVec2(left, from.y + pen.px(8)), pen.fonts->small, kText, "Soft tissue");
  const std::string_view words = in.toggles.soft_tissue ? "striped; T hides it" : "hidden; T shows it";
  pen.text(ImVec2(left, from.y + pen.px(31)), pen.fonts->small, kTextDim, words);
}

void draw_help(const OverlayInput& in, const Pen& pen) {
  const auto keys = key_bindings();
  const auto mouse = mouse_help();
  const auto listed = std::count_if(keys.begin(), keys.end(), [](const KeyBinding& k) { return !k.help.empty(); });
  const float row = pen.px(26);
  const float width = std::min(pen.px(470), in.width_px - pen.px(2 * kMargin));
  const float height = pen.px(76) + row * static_cast<float>(listed + static_cast<std::ptrdiff_t>(mouse.size()));
  const ImVec2 from((in.width_px - width) / 2, std::max(pen.px(kMargin), (in.height_px - height) / 2));
  pen.panel(from, ImVec2(from.x + width, from.y + height), 0.96F);
  pen.text(ImVec2(from.x + pen.px(28), from.y + pen.px(20)), pen.fonts->title, kText, "Keys");
  float y = from.y + pen.px(56);
  const auto line = [&](std::string_view key, std::string_view help) {
    pen.text(ImVec2(from.x + pen.px(28), y), pen.fonts->body, kAccent, key);
    pen.text(ImVec2(from.x + pen.px(150), y), pen.fonts->body, kText, help);
    y += row;
  };
  for (const KeyBinding& key : keys) {
    if (!key.help.empty()) {
      line(key.key_text, key.help);
    }
  }
  for (const MouseHelp& gesture : mouse) {
    line(gesture.gesture, gesture.help);
  }
}

}  // namespace enamel::view
