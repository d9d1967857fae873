#include "pipeline/decode/unwrap/links.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/decode/unwrap/byte_runs.hpp"
#include "pipeline/decode/unwrap/chosen.hpp"
#include "pipeline/decode/unwrap/link_rows.hpp"

namespace enamel::pipeline {
namespace {

std::size_t index(std::ptrdiff_t i) { return static_cast<std::size_t>(i); }

/// Whether a pixel beside a cut still sees its own surface only: its phase and its modulation go on from the two pixels
/// behind it.
struct Inland {
  static constexpr float kSigmas = 3 * 2.4494897F;  ///< derived: 3 sigma of a - 2b + c, which has sqrt(6) sigma

  const PhaseMaps& phase;
  const LinkMaps& links;

  /// The cut lies between i and i + step.
  [[nodiscard]] bool continues(std::ptrdiff_t i, std::ptrdiff_t step) const {
    const std::size_t here = index(i), near = index(i - step), far = index(i - 2 * step);
    const auto& link = std::abs(step) == 1 ? links.east : links.south;
    if (link[step > 0 ? near : here] == 0 || link[step > 0 ? far : near] == 0) return false;
    const float* p = phase.phase_rad.pixels().data();
    const float turn = wrap_once(wrap_once(p[here] - p[near]) - wrap_once(p[near] - p[far]));
    return std::abs(turn) < smaller(kSigmas * phase.sigma_rad[here], kMostInlandTurn_rad) &&
           phase.modulation_dn[here] > kLeastInlandModulation * phase.modulation_dn[near];
  }
};

}  // namespace

void unlink(LinkMaps& links, std::size_t i, std::size_t width) {
  links.east[i] = links.south[i] = links.quality[i] = 0;
  if (i > 0) links.east[i - 1] = 0;
  if (i >= width) links.south[i - width] = 0;
}

Carrier make_carrier(const float* phase_mid_rad, const RaySlopes& rays, double near_mm, float max_slope_deg) {
  // d(1/z) of one pixel's step on the slope is tan * px / z; in phase that is divided by d(1/z)/dPhi.
  const double tan_slope = std::tan(static_cast<double>(max_slope_deg) * std::numbers::pi / 180);
  const double per_px = tan_slope / (near_mm * std::abs(rays.inverse_depth_slope));
  return {phase_mid_rad, static_cast<float>(per_px * std::abs(rays.px_x)),
          static_cast<float>(per_px * std::abs(rays.px_y))};
}

void compute_links(const PhaseMaps& phase, const Carrier& carrier, const LinkConfig& config, LinkMaps& out) {
  const int w = phase.phase_rad.width(), h = phase.phase_rad.height();
  const auto width = static_cast<std::size_t>(w);
  if (out.east.width() != w || out.east.height() != h) out.east = out.south = out.quality = Map<std::uint8_t>(w, h);
  out.pairs = out.linked = 0;
  out.scratch.assign(3 * width + 1, kInvalidDifference);
  float* east = out.scratch.data() + 1;
  float* south = east + width;
  float* north = south + width;
  for (int v = 0; v < h; ++v) {
    const std::size_t at = static_cast<std::size_t>(v) * width;
    const PixelRow row{&phase.phase_rad[at], &phase.sigma_rad[at], carrier.phase_mid_rad + at, &phase.reject[at]};
    // Whole vectors: the last pixel's neighbour is the next row's first, where there is one, and does not count.
    const std::size_t eastern = v + 1 < h ? width : width - 1;
    difference_row(row, 1, eastern, east);
    east[width - 1] = kInvalidDifference;
    link_row(row, 1, eastern, east, carrier.slope_u_rad, config, &out.east[at]);
    out.east[at + width - 1] = 0;
    if (v + 1 < h) {
      difference_row(row, w, width, south);
      link_row(row, w, width, south, carrier.slope_v_rad, config, &out.south[at]);
    } else {
      std::fill_n(south, width, kInvalidDifference);
      std::fill_n(&out.south[at], width, std::uint8_t{0});
    }
    quality_row(row, width, east, south, north, &out.quality[at]);
    unsigned pairs = 0, linked = 0;
    for (std::size_t u = 0; u < width; ++u) pairs += static_cast<unsigned>(east[u] < 5);
    for (std::size_t u = 0; u < width; ++u) linked += out.east[at + u];
    out.pairs += pairs;
    out.linked += linked;
    std::swap(south, north);
  }
}

void reject_edges(LinkMaps& links, PhaseMaps& phase) {
  constexpr std::uint8_t kSentinel = 255;  // layout: ends every run
  const auto width = static_cast<std::ptrdiff_t>(phase.reject.width()), n = width * phase.reject.height();
  const Inland inland{phase, links};
  const auto cut = [&](std::ptrdiff_t i, std::ptrdiff_t step, bool room_before, bool room_after) {
    if (!room_before || !inland.continues(i, step)) phase.reject[index(i)] = PixelReject::kEdge;
    if (!room_after || !inland.continues(i + step, -step)) phase.reject[index(i + step)] = PixelReject::kEdge;
  };
  std::vector<std::uint8_t> marks(index(width) + kRunPadding, kSentinel);
  const auto each_cut = [&](std::ptrdiff_t at, std::ptrdiff_t step, const Map<std::uint8_t>& link, auto visit) {
    const std::size_t count = index(step == 1 ? width - 1 : width);
    std::fill(marks.begin(), marks.end(), kSentinel);
    // Whole vectors: a row's last pixel and the next row's first are marked too, and not visited.
    mark_cuts(&phase.reject[index(at)], step, &link[index(at)], at + width < n ? index(width) : count, marks.data());
    for (std::size_t u = end_of_run(marks.data(), 0, 0); u < count; u = end_of_run(marks.data(), u + 1, 0)) visit(u);
  };
  for (std::ptrdiff_t at = 0; at < n; at += width) {
    each_cut(at, 1, links.east, [&](std::size_t x) {
      const auto u = static_cast<std::ptrdiff_t>(x);
      cut(at + u, 1, u >= 2, u + 3 < width);
    });
  }
  for (std::ptrdiff_t at = 0; at + width < n; at += width) {
    each_cut(at, width, links.south, [&](std::size_t x) {
      const std::ptrdiff_t i = at + static_cast<std::ptrdiff_t>(x);
      cut(i, width, i >= 2 * width, i + 3 * width < n);
    });
  }
  const PixelReject* reject = phase.reject.pixels().data();
  for (std::size_t i = 0; i < phase.reject.size(); ++i) {
    const void* next = std::memchr(reject + i, static_cast<int>(PixelReject::kEdge), phase.reject.size() - i);
    if (next == nullptr) break;
    i = static_cast<std::size_t>(static_cast<const PixelReject*>(next) - reject);
    unlink(links, i, index(width));
  }
}

void reject_half_lit(const Map<float>& modulation_dn, Map<PixelReject>& reject) {
  const std::ptrdiff_t w = reject.width(), h = reject.height();
  if (w <= 2 * kHalfLitStep_px) return;
  for (std::ptrdiff_t v = 0; v < h; ++v) {
    const std::ptrdiff_t up = v >= kHalfLitStep_px ? -kHalfLitStep_px * w : 0,
                         down = v + kHalfLitStep_px < h ? kHalfLitStep_px * w : 0;
    const std::size_t first = index(v * w + kHalfLitStep_px);
    half_lit_row(&modulation_dn[first], kHalfLitStep_px, up, down, index(w - 2 * kHalfLitStep_px), &reject[first]);
  }
}

}  // namespace enamel::pipeline
