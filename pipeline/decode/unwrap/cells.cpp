#include "pipeline/decode/unwrap/cells.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/decode/unwrap/byte_runs.hpp"
#include "pipeline/decode/unwrap/chosen.hpp"
#include "pipeline/decode/unwrap/segment_rows.hpp"

namespace enamel::pipeline {
namespace {

/// derived: fringes; the bounds are taken at a segment's middle, and the ends of half a fringe reach that far.
constexpr float kRangeSlack = 0.25F;

void measure_bounds(const Map<float>& phi, const PhaseBounds& bounds, std::size_t at, Segment& p) {
  const std::size_t i = at + static_cast<std::size_t>((p.begin + p.end) / 2);
  // The row below has much the same segments: single pixels of a table are what no processor sees coming.
  const std::size_t below = std::min(i + static_cast<std::size_t>(phi.width()), phi.size() - 1);
  __builtin_prefetch(bounds.near_rad + below), __builtin_prefetch(bounds.far_rad + below);
  const float a = bounds.near_rad[i], b = bounds.far_rad[i];
  p.low = -floor_of(kRangeSlack - (smaller(a, b) - phi[i]) / kTwoPiF);
  p.high = floor_of((larger(a, b) - phi[i]) / kTwoPiF + kRangeSlack);
}

/// Links the segments of two neighbouring rows: each to the one of its component and cell with which it shares most
/// linked columns, unless a step lies between.
class Linker {
 public:
  explicit Linker(SegmentList& list)
      : segments_(list.segments), border_(list.work.border.data()), most_(list.work.most) {}

  /// Upper row: segments [upper, lower); lower row: [lower, end).
  void link(std::size_t upper, std::size_t lower, std::size_t end) {
    most_.assign(end - upper, 0);
    std::size_t first = upper;
    for (std::size_t k = lower; k < end; ++k) {
      while (first < lower && segments_[first].end <= segments_[k].begin) ++first;
      for (std::size_t o = first; o < lower && segments_[o].begin < segments_[k].end; ++o) {
        Segment &above = segments_[o], &below = segments_[k];
        if (above.component != below.component || above.cell != below.cell) continue;
        const BorderColumn sum = sum_over(std::max(above.begin, below.begin), std::min(above.end, below.end));
        const bool step = sum.seen > 0 && std::abs(sum.height) > sum.seen * kLeastStep &&
                          std::abs(sum.height) > sum.seen * step_threshold(sum.sigma / sum.seen, sum.seen);
        offer(most_[o - upper], sum.linked, step ? -1 : static_cast<std::int32_t>(k), above.down);
        offer(most_[k - upper], sum.linked, step ? -1 : static_cast<std::int32_t>(o), below.up);
      }
    }
  }

 private:
  static void offer(float& most, float linked, std::int32_t neighbour, std::int32_t& best) {
    if (!(linked > most)) return;
    most = linked;
    best = neighbour;
  }

  /// All four numbers of a column in one register (a vector type of g++ and clang).
  using Column [[gnu::vector_size(16)]] = float;
  static_assert(sizeof(Column) == sizeof(BorderColumn));

  [[nodiscard]] BorderColumn sum_over(std::int32_t begin, std::int32_t end) const {
    Column sum{}, column{};
    for (std::int32_t u = begin; u < end; ++u) {
      std::memcpy(&column, border_ + u, sizeof column);
      sum += column;
    }
    return std::bit_cast<BorderColumn>(sum);
  }

  std::vector<Segment>& segments_;
  const BorderColumn* border_;
  std::vector<float>& most_;
};

/// Between pixel `last` and pixel `next` of a row that begins at `at`.
Gap measure_gap(const PhaseMaps& phase, const Map<float>& phi, std::size_t at, std::int32_t last, std::int32_t next,
                std::int8_t rise) {
  int dark = 0;
  for (std::size_t i = at + static_cast<std::size_t>(last) + 1; i < at + static_cast<std::size_t>(next); ++i)
    dark += phase.reject[i] == PixelReject::kDark || phase.reject[i] == PixelReject::kNoisy ? 1 : 0;
  const float step = phi[at + static_cast<std::size_t>(next)] - phi[at + static_cast<std::size_t>(last)];
  const float rising = static_cast<float>(rise) * step / kTwoPiF;
  const float lean = std::ceil(-kGapBack - rising);
  return {rise * static_cast<std::int32_t>(lean), rise, dark >= kDarkGap_px && rising + lean <= kGapOn};
}

/// Whether Phi of a surface that faces the camera rises along rows.
std::int8_t rise_of_rows(const PhaseBounds& bounds, std::size_t width, std::size_t height) {
  const float* middle = bounds.near_rad + height / 2 * width;
  return middle[width - 1] < middle[0] ? std::int8_t{-1} : std::int8_t{1};
}

/// Segments of the row that begins at `at`, from its pixels' marks.
void split_row(const PhaseMaps& phase, const FloodMaps& flood, int v, std::size_t at, std::int8_t rise,
               SegmentList& out) {
  const Map<float>& phi = out.work.unwrapped;
  const std::uint8_t* marks = out.work.marks.data();
  std::vector<Segment>& segments = out.segments;
  const auto width = static_cast<std::size_t>(phi.width());
  const std::size_t before = segments.size();
  for (std::size_t u = end_of_run(marks, 0, kHole), end = 0; u < width; u = end_of_run(marks, end, kHole)) {
    end = end_of_run(marks, u + 1, kInside);
    const std::size_t i = at + u;
    const auto x = static_cast<std::int32_t>(u);
    const std::int32_t cell = 2 * flood.wraps[i] - (phase.phase_rad[i] < 0 ? 1 : 0);
    const bool joined = marks[u] != kFirst;
    const bool follows = !joined && segments.size() > before;
    const bool stepped = marks[u] == kAfterKink || marks[u] == kAfterShade;
    const Gap within{0, stepped ? rise : std::int8_t{0}, false};
    const Gap gap = follows ? measure_gap(phase, phi, at, segments.back().end - 1, x, rise) : within;
    segments.push_back({v, x, static_cast<std::int32_t>(end), flood.component[i], cell, -1, -1, 0, -1, joined,
                        marks[u] == kAfterKink, gap, phi[i], phi[at + end - 1]});
  }
}

/// Marks of the row that begins at `at`.
void mark_pixels(const PhaseMaps& phase, const LinkMaps& links, const FloodMaps& flood, const Map<std::uint8_t>& cuts,
                 std::size_t at, SegmentList& out) {
  const auto width = static_cast<std::size_t>(phase.phase_rad.width());
  auto& work = out.work;
  kink_row(&work.unwrapped[at], &phase.sigma_rad[at], width, work.heights.data(), work.borders.data());
  if (cuts.empty()) {
    const int height = phase.phase_rad.height(), v = static_cast<int>(at / width);
    const ShadeRows rows{&phase.modulation_dn[at], &phase.sigma_rad[at], &flood.component[at],
                         std::min(v, kShadeReach_px), std::min(height - 1 - v, kShadeReach_px)};
    shade_row(rows, width, work.shade_means.data(), work.heights.data(), work.borders.data());
  } else {
    std::uint8_t* __restrict borders = work.borders.data();
    const std::uint8_t* __restrict cut = &cuts[at];
    for (std::size_t u = 0; u < width; ++u)
      borders[u] = static_cast<std::uint8_t>(borders[u] | (cut[u] != 0 ? kKink : 0));
  }
  const FloodRow row{&phase.phase_rad[at], &flood.wraps[at], &flood.component[at], &links.east[at]};
  mark_row(row, &work.unwrapped[at], work.borders.data(), width, work.marks.data());
}

void prepare(const PhaseMaps& phase, const LinkMaps& links, const FloodMaps& flood, SegmentList& out) {
  constexpr std::uint8_t kSentinel = 255;  // layout: ends every run
  const int w = phase.phase_rad.width(), h = phase.phase_rad.height();
  const auto width = static_cast<std::size_t>(w);
  auto& work = out.work;
  out.segments.clear();
  work.heights.resize(width);
  work.borders.resize(width);
  work.shade_means.resize(width);
  work.border.resize(width);
  work.marks.assign(width + kRunPadding, kSentinel);
  if (work.unwrapped.width() != w || work.unwrapped.height() != h) work.unwrapped = Map<float>(w, h);
  for (std::size_t at = 0; at < work.unwrapped.size(); at += width) {
    unwrap_row({&phase.phase_rad[at], &flood.wraps[at], &flood.component[at], &links.east[at]}, width,
               &work.unwrapped[at]);
  }
}

}  // namespace

SegmentCore core_of(const std::vector<Segment>& segments, std::size_t k, std::int32_t trim_px,
                    std::int32_t width) noexcept {
  const Segment& p = segments[k];
  const bool begins = p.begin > 0 && (!p.joined || p.kink);
  const bool ends = p.end < width && (k + 1 == segments.size() || !segments[k + 1].joined || segments[k + 1].kink);
  return {p.begin + (begins ? trim_px : 0), p.end - (ends ? trim_px : 0)};
}

void find_segments(const PhaseMaps& phase, const LinkMaps& links, const FloodMaps& flood, const PhaseBounds& bounds,
                   const Map<std::uint8_t>& cuts, SegmentList& out) {
  constexpr int kContext_px = 5;  // layout: rows that border_row reaches
  prepare(phase, links, flood, out);
  auto& segments = out.segments;
  const Map<float>& phi = out.work.unwrapped;
  const auto width = static_cast<std::size_t>(phi.width());
  const int height = phi.height();
  const std::int8_t rise = rise_of_rows(bounds, width, static_cast<std::size_t>(height));
  std::size_t above = 0;
  for (int v = 0; v < height; ++v) {
    const std::size_t at = static_cast<std::size_t>(v) * width, first = segments.size();
    mark_pixels(phase, links, flood, cuts, at, out);
    split_row(phase, flood, v, at, rise, out);
    for (std::size_t k = first; k < segments.size(); ++k) measure_bounds(phi, bounds, at, segments[k]);
    if (v > 0) {
      const bool room = v >= kContext_px && v + kContext_px <= height;
      border_row(&phi[at], &phase.sigma_rad[at], &links.south[at - width], room, width, out.work.border.data());
      Linker(out).link(above, first, segments.size());
    }
    above = first;
  }
}

}  // namespace enamel::pipeline
