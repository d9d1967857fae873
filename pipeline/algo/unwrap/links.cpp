#include "pipeline/algo/unwrap/links.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

constexpr float kLaplaceSigmas = 3 * 4.4721360F;  // 3 sqrt(20): a noise-free smooth place keeps its quality
constexpr float kInvalidDifference = 10;          // any wrapped difference is below pi

inline float wrap(float d) noexcept {
  d = d > kPiF ? d - kTwoPiF : d;
  return d < -kPiF ? d + kTwoPiF : d;
}

struct PixelRow {
  const float* phase;
  const float* sigma;
  const float* carrier;
  const PixelReject* reject;
};

/// Wrapped difference to the neighbour `step` pixels on, less the carrier; kInvalidDifference beside an invalid pixel.
void differences(const PixelRow& r, std::ptrdiff_t step, std::size_t count, float* out) {
  for (std::size_t u = 0; u < count; ++u) {
    const auto n = static_cast<std::ptrdiff_t>(u) + step;
    const float d = wrap(r.phase[n] - r.phase[u]) - (r.carrier[n] - r.carrier[u]);
    const float e = wrap(d);
    const bool ok = (r.reject[n] == PixelReject::kNone) & (r.reject[u] == PixelReject::kNone);
    out[u] = ok ? e : kInvalidDifference;
  }
}

void decide(const PixelRow& r, std::ptrdiff_t step, std::size_t count, const float* difference, float slope,
            const LinkConfig& c, std::uint8_t* link) {
  for (std::size_t u = 0; u < count; ++u) {
    const auto n = static_cast<std::ptrdiff_t>(u) + step;
    const float noise = sqrt_poly(r.sigma[u] * r.sigma[u] + r.sigma[n] * r.sigma[n]);
    const float wide = slope + c.noise_sigmas * noise;
    const float limit = wide < c.max_deviation_rad ? wide : c.max_deviation_rad;
    link[u] = (difference[u] < limit) & (difference[u] > -limit) ? 1 : 0;
  }
}

void qualities(const PixelRow& r, std::size_t width, const float* east, const float* south, const float* north,
               std::uint8_t* out) {
  for (std::size_t u = 0; u < width; ++u) {
    const float west = u > 0 ? east[u - 1] : kInvalidDifference;
    const float l = (east[u] - west) + (south[u] - north[u]);
    const bool whole = (east[u] < 5) & (west < 5) & (south[u] < 5) & (north[u] < 5);
    const float x = whole ? l / (kLaplaceSigmas * r.sigma[u]) : 4.0F;  // border pixels wait
    const float q = 1.0F / (r.sigma[u] * (1.0F + x * x));
    // Eight steps an octave straight from the float's exponent and mantissa; 2^-4 … 2^27 covers all qualities.
    const int level = static_cast<int>(std::bit_cast<std::uint32_t>(q) >> 20U) - (123 << 3);
    const int clamped = level < 1 ? 1 : (level > 255 ? 255 : level);
    out[u] = r.reject[u] == PixelReject::kNone ? static_cast<std::uint8_t>(clamped) : std::uint8_t{0};
  }
}

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
  out.scratch.assign(3 * width, kInvalidDifference);
  float* east = out.scratch.data();
  float* south = east + width;
  float* north = south + width;
  for (int v = 0; v < h; ++v) {
    const std::size_t at = static_cast<std::size_t>(v) * width;
    const PixelRow row{&phase.phase_rad[at], &phase.sigma_rad[at], carrier.phase_mid_rad + at, &phase.reject[at]};
    differences(row, 1, width - 1, east);
    east[width - 1] = kInvalidDifference;
    decide(row, 1, width - 1, east, carrier.slope_u_rad, config, &out.east[at]);
    out.east[at + width - 1] = 0;
    if (v + 1 < h) {
      differences(row, w, width, south);
      decide(row, w, width, south, carrier.slope_v_rad, config, &out.south[at]);
    } else {
      std::fill_n(south, width, kInvalidDifference);
      std::fill_n(&out.south[at], width, std::uint8_t{0});
    }
    qualities(row, width, east, south, north, &out.quality[at]);
    for (std::size_t u = 0; u + 1 < width; ++u) out.pairs += east[u] < 5 ? 1 : 0;
    for (std::size_t u = 0; u + 1 < width; ++u) out.linked += out.east[at + u];
    std::swap(south, north);
  }
}

void reject_edges(LinkMaps& links, Map<PixelReject>& reject) {
  const std::size_t width = static_cast<std::size_t>(reject.width()), n = reject.size();
  const auto valid = [&](std::size_t i) { return reject[i] == PixelReject::kNone || reject[i] == PixelReject::kEdge; };
  for (std::size_t v = 0; v < static_cast<std::size_t>(reject.height()); ++v)
    for (std::size_t i = v * width; i + 1 < (v + 1) * width; ++i)
      if (links.east[i] == 0 && valid(i) && valid(i + 1)) reject[i] = reject[i + 1] = PixelReject::kEdge;
  for (std::size_t i = 0; i + width < n; ++i)
    if (links.south[i] == 0 && valid(i) && valid(i + width)) reject[i] = reject[i + width] = PixelReject::kEdge;
  for (std::size_t i = 0; i < n; ++i) {
    if (reject[i] != PixelReject::kEdge) continue;
    links.east[i] = links.south[i] = links.quality[i] = 0;
    if (i > 0) links.east[i - 1] = 0;
    if (i >= width) links.south[i - width] = 0;
  }
}

void reject_half_lit(const Map<float>& modulation_dn, Map<PixelReject>& reject) {
  constexpr std::ptrdiff_t kStep_px = 2;
  const std::ptrdiff_t w = reject.width(), h = reject.height();
  const float* b = modulation_dn.pixels().data();
  PixelReject* r = reject.pixels().data();
  for (std::ptrdiff_t v = 0; v < h; ++v) {
    const std::ptrdiff_t up = v >= kStep_px ? -kStep_px * w : 0, down = v + kStep_px < h ? kStep_px * w : 0;
    for (std::ptrdiff_t i = v * w + kStep_px; i < (v + 1) * w - kStep_px; ++i) {
      const float across = b[i - kStep_px] > b[i + kStep_px] ? b[i - kStep_px] : b[i + kStep_px];
      const float along = b[i + up] > b[i + down] ? b[i + up] : b[i + down];
      const float most = across > along ? across : along;
      r[i] = (r[i] == PixelReject::kNone) & (b[i] < 0.5F * most) ? PixelReject::kEdge : r[i];
    }
  }
}

}  // namespace enamel::algo
