#include "pipeline/algo/unwrap/cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

constexpr float kRangeSlack = 0.25F;  ///< fringes: the bounds are taken at a piece's middle, its ends reach that far

void measure_bounds(const PhaseMaps& phase, const FloodMaps& flood, const PhaseBounds& bounds, std::size_t at,
                    Piece& p) {
  const std::size_t i = at + static_cast<std::size_t>((p.begin + p.end) / 2);
  const float a = bounds.near_rad[i], b = bounds.far_rad[i];
  const float phi = phase.phase_rad[i] + kTwoPiF * flood.turn[i];
  p.low = static_cast<std::int32_t>(std::ceil((std::min(a, b) - phi) / kTwoPiF - kRangeSlack));
  p.high = static_cast<std::int32_t>(std::floor((std::max(a, b) - phi) / kTwoPiF + kRangeSlack));
}

/// Height of a step between positions -1 and 0 of a line of Phi (stride in pixels), as excess over the slopes beside
/// it; blur spreads a step over three pixels. One-sided at the end of a surface; NaN where there is nothing to compare.
float step_height(const float* p, std::ptrdiff_t stride) {
  const float middle = p[stride] - p[-2 * stride];
  const float before = p[-2 * stride] - p[-5 * stride], after = p[4 * stride] - p[stride];
  const float slope = before == before ? (after == after ? 0.5F * (before + after) : before) : after;
  return middle - slope;
}

/// Smallest step that is neither noise (4 sigma of six samples' combination) nor ripple of the three-frame phase.
float step_threshold(float sigma, float samples) { return 4 * root(6.0F / samples) * sigma + 0.1F; }

constexpr std::size_t kKinkContext_px = 6;

/// Marks in a row's `kinks` where a step lies between a pixel and the one before it: once, where it is highest.
void find_kinks(const PhaseMaps& phase, const Map<float>& phi, std::size_t at, std::vector<float>& heights,
                std::vector<std::uint8_t>& kinks) {
  const auto width = static_cast<std::size_t>(phi.width());
  heights.assign(width, 0);
  kinks.assign(width, 0);
  if (width <= 2 * kKinkContext_px) return;
  const float* __restrict p = &phi[at];
  float* __restrict height = heights.data();
  for (std::size_t u = kKinkContext_px - 1; u + kKinkContext_px < width + 1; ++u) {
    const float middle = p[u + 1] - p[u - 2], before = p[u - 2] - p[u - 5], after = p[u + 4] - p[u + 1];
    const bool left = before == before, right = after == after;
    const float slope = select(left, select(right, 0.5F * (before + after), before), after);
    height[u] = std::abs(middle - slope);
  }
  const float* __restrict sigma = &phase.sigma_rad[at];
  std::uint8_t* __restrict out = kinks.data();
  for (std::size_t u = kKinkContext_px; u + kKinkContext_px < width; ++u) {
    const unsigned step = static_cast<unsigned>(height[u] > step_threshold(sigma[u], 1));
    const unsigned before = static_cast<unsigned>(height[u - 1] > height[u]);
    const unsigned after = static_cast<unsigned>(height[u + 1] >= height[u]);
    out[u] = static_cast<std::uint8_t>(step & (before ^ 1U) & (after ^ 1U));
  }
}

/// A step between rows v-1 and v, as the mean over columns begin … end-1 of row v (i = index of column 0 of that row).
bool is_step_between_rows(const PhaseMaps& phase, const Map<float>& phi, std::size_t i, std::int32_t begin,
                          std::int32_t end) {
  const auto width = static_cast<std::ptrdiff_t>(phi.width());
  float sum = 0, sigma = 0, count = 0;
  for (std::int32_t u = begin; u < end; ++u) {
    const std::size_t k = i + static_cast<std::size_t>(u);
    const float j = step_height(&phi[k], width);
    const bool ok = j == j;
    sum += ok ? j : 0;
    sigma += ok ? phase.sigma_rad[k] : 0;
    count += ok ? 1.0F : 0.0F;
  }
  return count > 0 && std::abs(sum) > count * step_threshold(sigma / count, count);
}

struct Linker {
  static constexpr std::int32_t kStepFound = -2;  ///< kStepFound - k: linked to k, but for a step between

  const PhaseMaps& phase;
  const Map<float>& phi;
  std::vector<Piece>& pieces;
  const std::uint8_t* south;  ///< links of the upper row to the lower
  std::size_t lower_row_at;   ///< index of the lower row's first pixel
  bool room;                  ///< enough rows above and below to look for a step

  /// The candidate among [first, last) of the other row that shares most linked columns with `p`; -1 when none does.
  std::int32_t best_overlap(const Piece& p, std::size_t first, std::size_t last) const {
    std::int32_t best = -1, most = 0;
    for (std::size_t k = first; k < last; ++k) {
      const Piece& o = pieces[k];
      if (o.end <= p.begin) continue;
      if (o.begin >= p.end) break;
      if (o.component != p.component || o.cell != p.cell) continue;
      std::int32_t shared = 0;
      for (std::int32_t u = std::max(o.begin, p.begin); u < std::min(o.end, p.end); ++u) shared += south[u];
      if (shared > most) most = shared, best = static_cast<std::int32_t>(k);
    }
    return best;
  }

  bool step_between(const Piece& p, std::int32_t other) const {
    const Piece& o = pieces[static_cast<std::size_t>(other)];
    return room && is_step_between_rows(phase, phi, lower_row_at, std::max(o.begin, p.begin), std::min(o.end, p.end));
  }

  void link(std::size_t a0, std::size_t b0, std::size_t end) const {
    std::size_t from = a0;
    for (std::size_t k = b0; k < end; ++k) {
      while (from < b0 && pieces[from].end <= pieces[k].begin) ++from;
      const std::int32_t other = best_overlap(pieces[k], from, b0);
      pieces[k].up = other >= 0 && step_between(pieces[k], other) ? kStepFound - other : other;
    }
    from = b0;
    for (std::size_t k = a0; k < b0; ++k) {
      while (from < end && pieces[from].end <= pieces[k].begin) ++from;
      const std::int32_t other = best_overlap(pieces[k], from, end);
      if (other < 0) continue;
      const std::int32_t back = pieces[static_cast<std::size_t>(other)].up, self = static_cast<std::int32_t>(k);
      const bool known = back == self || back == kStepFound - self;  // looked at from the other side already
      const bool step = known ? back != self : step_between(pieces[k], other);
      pieces[k].down = step ? -1 : other;
    }
    for (std::size_t k = b0; k < end; ++k) pieces[k].up = std::max(pieces[k].up, -1);
  }
};

void unwrap_map(const PhaseMaps& phase, const FloodMaps& flood, Map<float>& phi) {
  if (phi.width() != phase.phase_rad.width() || phi.height() != phase.phase_rad.height())
    phi = Map<float>(phase.phase_rad.width(), phase.phase_rad.height());
  for (std::size_t i = 0; i < phi.size(); ++i) {
    const float p = phase.phase_rad[i] + kTwoPiF * static_cast<float>(flood.turn[i]);
    phi[i] = flood.component[i] >= 0 ? p : std::numeric_limits<float>::quiet_NaN();
  }
}

/// Between pixel `last` and pixel `next` of a row that begins at `at`.
Gap measure_gap(const PhaseMaps& phase, const Map<float>& phi, std::size_t at, std::int32_t last, std::int32_t next,
                std::int8_t rise) {
  constexpr float kBack = 0.08F, kOn = 0.22F;  // fringes: noise; pixels lost to blur at both ends and noise
  constexpr int kDarkPixels = 2;
  int dark = 0;
  for (std::size_t i = at + static_cast<std::size_t>(last) + 1; i < at + static_cast<std::size_t>(next); ++i)
    dark += phase.reject[i] == PixelReject::kDark || phase.reject[i] == PixelReject::kNoisy ? 1 : 0;
  const float step = phi[at + static_cast<std::size_t>(next)] - phi[at + static_cast<std::size_t>(last)];
  const float rising = static_cast<float>(rise) * step / kTwoPiF;
  const float lean = std::ceil(-kBack - rising);
  return {rise * static_cast<std::int32_t>(lean), rise, dark >= kDarkPixels && rising + lean <= kOn};
}

/// Whether Phi of a surface that faces the camera rises along rows.
std::int8_t rise_of_rows(const PhaseBounds& bounds, std::size_t width, std::size_t height) {
  const float* middle = bounds.near_rad + height / 2 * width;
  return middle[width - 1] < middle[0] ? std::int8_t{-1} : std::int8_t{1};
}

void split_row(const PhaseMaps& phase, const LinkMaps& links, const FloodMaps& flood, const Map<std::uint8_t>& cuts,
               int v, std::int8_t rise, PieceList& out) {
  const Map<float>& phi = out.work.unwrapped;
  std::vector<Piece>& pieces = out.pieces;
  const auto width = static_cast<std::size_t>(phi.width());
  const std::size_t at = static_cast<std::size_t>(v) * width;
  find_kinks(phase, phi, at, out.work.heights, out.work.kinks);
  bool open = false;  // does the last piece of the list end at the pixel before u
  for (std::size_t u = 0; u < width; ++u) {
    const std::size_t i = at + u;
    if (flood.component[i] < 0) {
      open = false;
      continue;
    }
    const int cell = 2 * flood.turn[i] - (phase.phase_rad[i] < 0 ? 1 : 0);
    // A difference beyond pi: two paths of the flood disagree here.
    const bool joined = open && links.east[i - 1] != 0 && flood.component[i - 1] == flood.component[i] &&
                        std::abs(phi[i] - phi[i - 1]) < kPiF;
    const bool cut = !cuts.empty() && cuts[i] != 0;
    const bool kink = joined && (cut || out.work.kinks[u] != 0);
    if (!joined || kink || pieces.back().cell != cell) {
      const auto x = static_cast<std::int32_t>(u);
      const bool follows = !joined && !pieces.empty() && pieces.back().row == v;
      const Gap gap = follows ? measure_gap(phase, phi, at, pieces.back().end - 1, x, rise) : Gap{};
      pieces.push_back({v, x, x, flood.component[i], cell, -1, -1, 0, -1, joined, kink, gap});
    }
    pieces.back().end = static_cast<std::int32_t>(u) + 1;
    open = true;
  }
}

}  // namespace

PieceCore core_of(const std::vector<Piece>& pieces, std::size_t k, std::int32_t trim_px) noexcept {
  const Piece& p = pieces[k];
  const bool last_of_run = k + 1 == pieces.size() || !pieces[k + 1].joined || pieces[k + 1].kink;
  return {p.begin + (p.joined && !p.kink ? 0 : trim_px), p.end - (last_of_run ? trim_px : 0)};
}

void find_pieces(const PhaseMaps& phase, const LinkMaps& links, const FloodMaps& flood, const PhaseBounds& bounds,
                 const Map<std::uint8_t>& cuts, PieceList& out) {
  constexpr int kContext_px = 5;
  auto& pieces = out.pieces;
  pieces.clear();
  unwrap_map(phase, flood, out.work.unwrapped);
  const auto width = static_cast<std::size_t>(phase.phase_rad.width());
  const int height = phase.phase_rad.height();
  const std::int8_t rise = rise_of_rows(bounds, width, static_cast<std::size_t>(height));
  std::size_t above = 0;
  for (int v = 0; v < height; ++v) {
    const std::size_t at = static_cast<std::size_t>(v) * width, first = pieces.size();
    split_row(phase, links, flood, cuts, v, rise, out);
    for (std::size_t k = first; k < pieces.size(); ++k) measure_bounds(phase, flood, bounds, at, pieces[k]);
    const bool room = v >= kContext_px && v + kContext_px <= height;
    if (v > 0)
      Linker{phase, out.work.unwrapped, pieces, &links.south[at - width], at, room}.link(above, first, pieces.size());
    above = first;
  }
}

}  // namespace enamel::algo
