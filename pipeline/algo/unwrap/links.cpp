#include "pipeline/algo/unwrap/links.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/algo/phase/poly_trig.hpp"
#include "pipeline/algo/unwrap/link_rows.hpp"

namespace enamel::algo {
namespace {

void unlink(LinkMaps& links, std::size_t i, std::size_t width) {
  links.east[i] = links.south[i] = links.quality[i] = 0;
  if (i > 0) links.east[i - 1] = 0;
  if (i >= width) links.south[i - width] = 0;
}

std::size_t index(std::ptrdiff_t i) { return static_cast<std::size_t>(i); }

/// Whether a pixel beside a cut still sees its own surface only: its phase and its modulation go on from the two pixels
/// behind it. A fifth of the light from the other side turns the phase by up to 0.2 rad or takes as much modulation.
struct Inland {
  static constexpr float kSigmas = 3 * 2.4494897F;  ///< of a - 2b + c: sqrt(6) sigma
  static constexpr float kMostTurn_rad = 0.3F;
  static constexpr float kLeastModulation = 0.85F;

  const PhaseMaps& phase;
  const LinkMaps& links;

  /// The cut lies between i and i + step.
  [[nodiscard]] bool continues(std::ptrdiff_t i, std::ptrdiff_t step) const {
    const std::size_t here = index(i), near = index(i - step), far = index(i - 2 * step);
    const auto& link = std::abs(step) == 1 ? links.east : links.south;
    if (link[step > 0 ? near : here] == 0 || link[step > 0 ? far : near] == 0) return false;
    const float* p = phase.phase_rad.pixels().data();
    const float turn = wrap_once(wrap_once(p[here] - p[near]) - wrap_once(p[near] - p[far]));
    return std::abs(turn) < smaller(kSigmas * phase.sigma_rad[here], kMostTurn_rad) &&
           phase.modulation_dn[here] > kLeastModulation * phase.modulation_dn[near];
  }
};

}  // namespace

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
    difference_row(row, 1, width - 1, east);
    east[width - 1] = kInvalidDifference;
    link_row(row, 1, width - 1, east, carrier.slope_u_rad, config, &out.east[at]);
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
    for (std::size_t u = 0; u + 1 < width; ++u) pairs += static_cast<unsigned>(east[u] < 5);
    for (std::size_t u = 0; u + 1 < width; ++u) linked += out.east[at + u];
    out.pairs += pairs;
    out.linked += linked;
    std::swap(south, north);
  }
}

void reject_edges(LinkMaps& links, PhaseMaps& phase) {
  const auto width = static_cast<std::ptrdiff_t>(phase.reject.width()), n = width * phase.reject.height();
  const Inland inland{phase, links};
  const auto valid = [&](std::ptrdiff_t i) {
    const PixelReject r = phase.reject[index(i)];
    return r == PixelReject::kNone || r == PixelReject::kEdge;
  };
  const auto cut = [&](std::ptrdiff_t i, std::ptrdiff_t step, bool room_before, bool room_after) {
    if (!valid(i) || !valid(i + step)) return;
    if (!room_before || !inland.continues(i, step)) phase.reject[index(i)] = PixelReject::kEdge;
    if (!room_after || !inland.continues(i + step, -step)) phase.reject[index(i + step)] = PixelReject::kEdge;
  };
  for (std::ptrdiff_t v = 0; v * width < n; ++v) {
    for (std::ptrdiff_t u = 0; u + 1 < width; ++u)
      if (links.east[index(v * width + u)] == 0) cut(v * width + u, 1, u >= 2, u + 3 < width);
  }
  for (std::ptrdiff_t i = 0; i + width < n; ++i)
    if (links.south[index(i)] == 0) cut(i, width, i >= 2 * width, i + 3 * width < n);
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    if (phase.reject[index(i)] == PixelReject::kEdge) unlink(links, index(i), index(width));
  }
}

void reject_parted(const std::vector<SaturatedPixel>& pixels, LinkMaps& links, Map<PixelReject>& reject) {
  const std::size_t width = static_cast<std::size_t>(reject.width()), n = reject.size();
  const auto cut = [&](std::size_t a, std::size_t b, const Map<std::uint8_t>& link) {
    return link[a] == 0 && reject[a] == PixelReject::kNone && reject[b] == PixelReject::kNone;
  };
  for (const SaturatedPixel& p : pixels) {
    const std::size_t i = p.index, u = i % width;
    const bool parted = (u + 1 < width && cut(i, i + 1, links.east)) || (u > 0 && cut(i - 1, i, links.east)) ||
                        (i + width < n && cut(i, i + width, links.south)) ||
                        (i >= width && cut(i - width, i, links.south));
    if (!parted) continue;
    reject[i] = PixelReject::kSaturated;
    unlink(links, i, width);
  }
}

void reject_half_lit(const Map<float>& modulation_dn, Map<PixelReject>& reject) {
  constexpr std::ptrdiff_t kStep_px = 2;
  const std::ptrdiff_t w = reject.width(), h = reject.height();
  const float* b = modulation_dn.pixels().data();
  PixelReject* r = reject.pixels().data();
  for (std::ptrdiff_t v = 0; v < h; ++v) {
    const std::ptrdiff_t up = v >= kStep_px ? -kStep_px * w : 0, down = v + kStep_px < h ? kStep_px * w : 0;
    const float* __restrict west = b + v * w, * __restrict east = west + 2 * kStep_px, * __restrict here = west + kStep_px;
    const float* __restrict above = here + up, * __restrict below = here + down;
    PixelReject* __restrict out = r + v * w + kStep_px;
    for (std::ptrdiff_t u = 0; u < w - 2 * kStep_px; ++u) {
      const float most = larger(larger(west[u], east[u]), larger(above[u], below[u]));
      const unsigned half_lit = static_cast<unsigned>(here[u] < 0.5F * most);
      const auto was = static_cast<unsigned>(out[u]);
      out[u] = static_cast<PixelReject>(was == 0 ? half_lit * static_cast<unsigned>(PixelReject::kEdge) : was);
    }
  }
}

}  // namespace enamel::algo
