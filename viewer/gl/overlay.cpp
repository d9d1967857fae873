#include "viewer/gl/overlay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

namespace enamel::view {
namespace {

constexpr float kMargin = 20;

std::string number(double value, const char* format) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

void draw_frame_line(const OverlayInput& in, const Pen& pen) {
  const float w = pen.px(4);
  pen.list->AddRect(ImVec2(w / 2, w / 2), ImVec2(in.width_px - w / 2, in.height_px - w / 2),
                    packed(in.status.colour, 0.85F), 0, 0, w);
}

void draw_state(const OverlayInput& in, const Pen& pen) {
  const ImVec2 title = pen.size(pen.fonts->title, in.status.title);
  const ImVec2 hint = pen.size(pen.fonts->body, in.status.hint);
  const bool with_hint = !in.status.hint.empty();
  const float inner = std::max(title.x + pen.px(24), hint.x);
  const float width = inner + pen.px(44);
  const float height = title.y + pen.px(20) + (with_hint ? hint.y + pen.px(3) : 0);
  const ImVec2 from((in.width_px - width) / 2, pen.px(kMargin));
  pen.panel(from, ImVec2(from.x + width, from.y + height), 0.84F);
  const float x = from.x + (width - title.x - pen.px(24)) / 2;
  const float y = from.y + pen.px(10);
  pen.list->AddCircleFilled(ImVec2(x + pen.px(7), y + title.y / 2), pen.px(7), packed(in.status.colour), 32);
  pen.text(ImVec2(x + pen.px(24), y), pen.fonts->title, in.status.colour, in.status.title);
  if (with_hint) {
    pen.text(ImVec2(from.x + (width - hint.x) / 2, y + title.y + pen.px(3)), pen.fonts->body, kText, in.status.hint);
  }
}

void draw_brand(const OverlayInput& in, const Pen& pen) {
  const ImVec2 at(pen.px(kMargin + 4), pen.px(kMargin + 2));
  pen.text(at, pen.fonts->title, kText, "enamel");
  if (!in.frame->simulated) {
    return;
  }
  const ImVec2 words = pen.size(pen.fonts->small, "SIMULATED");
  const ImVec2 from(at.x + pen.size(pen.fonts->title, "enamel").x + pen.px(14), at.y - pen.px(1));
  const ImVec2 to(from.x + words.x + pen.px(20), from.y + words.y + pen.px(10));
  pen.list->AddRectFilled(from, to, packed(kWeak, 0.95F), pen.px(8));
  pen.text(ImVec2(from.x + pen.px(10), from.y + pen.px(5)), pen.fonts->small, {0.10F, 0.07F, 0.02F}, "SIMULATED");
}

struct Row {
  const char* label;
  std::string value;
  Colour colour = kText;
};

std::array<Row, 7> figure_rows(const OverlayInput& in) {
  const PreviewFrame& f = *in.frame;
  const auto loss = [](std::uint64_t n) { return n > 0 ? kBad : kText; };
  const auto notice = [](std::uint64_t n) { return n > 0 ? kWeak : kText; };
  return {Row{"Rate", std::isfinite(f.rate_hz) && f.rate_hz > 0 ? number(f.rate_hz, "%.1f /s") : "-"},
          Row{"Latency", std::isfinite(f.latency_ms) && f.latency_ms > 0 ? number(f.latency_ms, "%.0f ms") : "-"},
          Row{"Triangles", grouped(in.triangles)},
          Row{"Rejected", grouped(f.counters.rejected)},
          Row{"Shed", grouped(f.counters.shed), notice(f.counters.shed)},
          Row{"Incomplete", grouped(f.counters.incomplete), loss(f.counters.incomplete)},
          Row{"Lost on the wire", grouped(f.counters.lost_on_wire), loss(f.counters.lost_on_wire)}};
}

/// Returns where it ends.
float draw_figures(const OverlayInput& in, const Pen& pen) {
  const auto rows = figure_rows(in);
  const float row_height = pen.px(24);
  const float width = pen.px(214);
  const float head = pen.px(84);
  const float height = head + row_height * static_cast<float>(rows.size()) + pen.px(12);
  const ImVec2 to(in.width_px - pen.px(kMargin), pen.px(kMargin) + height);
  const ImVec2 from(to.x - width, pen.px(kMargin));
  pen.panel(from, to);
  const float left = from.x + pen.px(16);
  const float right = to.x - pen.px(16);
  pen.text(ImVec2(left, from.y + pen.px(11)), pen.fonts->big, kText, grouped(in.frame->counters.fused));
  pen.text(ImVec2(left, from.y + pen.px(51)), pen.fonts->small, kTextDim,
           "fused of " + grouped(in.frame->counters.captured) + " bursts");
  pen.list->AddLine(ImVec2(left, from.y + head - pen.px(8)), ImVec2(right, from.y + head - pen.px(8)),
                    packed({1, 1, 1}, 0.12F), pen.px(1));
  float y = from.y + head;
  for (const Row& row : rows) {
    pen.text(ImVec2(left, y), pen.fonts->small, kTextDim, row.label);
    pen.text_right(ImVec2(right, y), pen.fonts->small, row.colour, row.value);
    y += row_height;
  }
  return to.y;
}

void draw_message(const OverlayInput& in, const Pen& pen) {
  if (in.frame->message.empty()) {
    return;
  }
  const float wrap = std::min(pen.px(480), in.width_px * 0.5F);
  const ImVec2 size = pen.size(pen.fonts->body, in.frame->message, wrap);
  const float width = size.x + pen.px(44);
  const float height = size.y + pen.px(24);
  const ImVec2 from((in.width_px - width) / 2, in.height_px - pen.px(kMargin + 6) - height);
  pen.panel(from, ImVec2(from.x + width, from.y + height), 0.94F);
  pen.list->AddRectFilled(from, ImVec2(from.x + pen.px(6), from.y + height), packed(kWeak), pen.px(3));
  pen.text(ImVec2(from.x + pen.px(24), from.y + pen.px(12)), pen.fonts->body, kText, in.frame->message, wrap);
}

/// A large target for a gloved finger. Returns true when pressed.
bool draw_scan_button(const OverlayInput& in, const Pen& pen) {
  const bool scanning = in.frame->state == ScanState::kScanning;
  const bool usable = scanning || in.frame->state == ScanState::kPaused;
  if (!usable || !in.interactive) {
    return false;
  }
  const ImVec2 size(pen.px(132), pen.px(52));
  ImGui::SetNextWindowPos(ImVec2(in.width_px - pen.px(kMargin) - size.x, in.height_px - pen.px(kMargin) - size.y));
  ImGui::SetNextWindowSize(size);
  ImGui::Begin("scan", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoNav |
                   ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
  ImGui::PushFont(pen.fonts->title);
  const bool pressed = ImGui::Button(scanning ? "Pause" : "Scan", size);
  ImGui::PopFont();
  ImGui::End();
  return pressed;
}

}  // namespace

bool draw_overlay(const OverlayInput& input, const Fonts& fonts) {
  const Pen pen{ImGui::GetBackgroundDrawList(), &fonts, input.scale};
  draw_frame_line(input, pen);
  draw_brand(input, pen);
  draw_state(input, pen);
  if (input.toggles.live_image) {
    draw_live_corner(input, pen);
  }
  if (input.return_texture != 0) {
    draw_return_corner(input, pen);
  }
  float right_column = 0;
  if (input.toggles.panels) {
    right_column = draw_figures(input, pen);
  }
  if (input.toggles.stages && input.frame->pipeline) {
    draw_stages(input, pen, ImVec2(input.width_px - pen.px(kMargin), right_column + pen.px(kMargin)));
  }
  draw_message(input, pen);
  const bool pressed = draw_scan_button(input, pen);
  const float button_top = input.height_px - pen.px(kMargin + (input.interactive ? 64 : 0));
  if (input.toggles.quality_map) {
    draw_legend(input, pen, ImVec2(input.width_px - pen.px(kMargin), button_top));
  }
  draw_soft_legend(input, pen, ImVec2(input.width_px - pen.px(kMargin), button_top));
  if (input.toggles.help) {
    draw_help(input, pen);
  } else if (input.interactive) {
    const ImVec2 words = pen.size(fonts.small, "F1  Help");
    pen.text(ImVec2(input.width_px - pen.px(kMargin + 146) - words.x, input.height_px - pen.px(kMargin + 18) - words.y),
             fonts.small, kTextDim, "F1  Help");
  }
  return pressed;
}

}  // namespace enamel::view
