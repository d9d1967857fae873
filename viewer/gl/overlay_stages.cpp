// The pipeline at work: each stage's time, queue and what it waits for, and which one sets the rate.
#include <algorithm>
#include <vector>

#include "viewer/gl/overlay.hpp"

namespace enamel::view {
namespace {

constexpr float kPadding = 16;
constexpr float kHead = 34;
constexpr float kRow = 43;

struct Columns {
  float left, right, width;
};

Columns columns_for(const std::vector<StageLine>& lines, const Pen& pen, float right_edge) {
  float inner = pen.px(200);
  for (const StageLine& line : lines) {
    const float times = pen.size(pen.fonts->small, line.name).x + pen.size(pen.fonts->small, line.times).x + pen.px(18);
    inner = std::max({inner, times, pen.size(pen.fonts->small, line.rest).x});
  }
  return {right_edge - pen.px(kPadding) - inner, right_edge - pen.px(kPadding), inner};
}

void draw_stage(const StageLine& line, const Columns& at, float y, const Pen& pen) {
  pen.text(ImVec2(at.left, y), pen.fonts->small, kText, line.name);
  pen.text_right(ImVec2(at.right, y), pen.fonts->small, kText, line.times);
  pen.text(ImVec2(at.left, y + pen.px(17)), pen.fonts->small, kTextDim, line.rest);
  const float bar = y + pen.px(35);
  const auto part = [&](float share, const Colour& colour, float alpha) {
    pen.list->AddRectFilled(ImVec2(at.left, bar), ImVec2(at.left + share * at.width, bar + pen.px(3)),
                            packed(colour, alpha), pen.px(1.5F));
  };
  part(1, {1, 1, 1}, 0.10F);
  part(line.busy, kAccent, 0.9F);
}

}  // namespace

void draw_stages(const OverlayInput& in, const Pen& pen, ImVec2 top_right) {
  const PipelineFigures& figures = *in.frame->pipeline;
  const std::vector<StageLine> lines = stage_lines(figures);
  const Columns at = columns_for(lines, pen, top_right.x);
  const ImVec2 words = pen.size(pen.fonts->small, figures.bottleneck, at.width);
  const float rows = pen.px(kRow) * static_cast<float>(lines.size());
  const ImVec2 from(at.left - pen.px(kPadding), top_right.y);
  pen.panel(from, ImVec2(top_right.x, from.y + pen.px(kHead) + rows + words.y + pen.px(12)));
  pen.text(ImVec2(at.left, from.y + pen.px(9)), pen.fonts->small, kTextDim, "Stages, median / 95 %");
  float y = from.y + pen.px(kHead);
  for (const StageLine& line : lines) {
    draw_stage(line, at, y, pen);
    y += pen.px(kRow);
  }
  pen.text(ImVec2(at.left, y), pen.fonts->small, kText, figures.bottleneck, at.width);
}

}  // namespace enamel::view
