#include "pipeline/algo/decode/surface.hpp"

#include <limits>

#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct RowOut {
  float *inverse, *depth, *sigma, *wrapped;
  std::uint8_t* order;
  PixelReject* reject;
};

/// sin 4phi from the unit vector of phi, which needs no trigonometry.
inline float sin_four(float c, float s) noexcept {
  const float inv2 = 1.0F / (c * c + s * s + 1e-6F);
  return 4 * c * s * inv2 * ((c - s) * (c + s) * inv2);
}

void solve_row(const PhaseMaps& m, const PolarityMaps& p, const RayDepth& rays, float fourth, std::size_t at,
               std::size_t width, const RowOut& o) {
  const float q_near = 1.0F / rays.near_mm, q_far = 1.0F / rays.far_mm;
  for (std::size_t u = 0; u < width; ++u) {
    const std::size_t i = at + u;
    const float raw = m.phase_rad[i] - fourth * sin_four(m.cosine_dn[i], m.sine_dn[i]);
    const int turns = p.turn[i] + (raw >= kPiF ? 1 : 0) - (raw < -kPiF ? 1 : 0);
    const float phi = raw >= kPiF ? raw - kTwoPiF : (raw < -kPiF ? raw + kTwoPiF : raw);
    const float absolute = phi + kTwoPiF * static_cast<float>(turns);
    const float q = rays.inverse_depth(i, absolute);
    const float slope = rays.inverse_depth_slope(i, absolute);
    const bool inside =
        (q <= q_near) & (q >= q_far) & (absolute > rays.min_phase_rad) & (absolute < rays.max_phase_rad);
    const bool candidate = o.reject[u] == PixelReject::kNone;
    const bool ok = candidate & inside;
    const float z = 1.0F / (ok ? q : 1.0F);
    o.reject[u] = candidate & !inside ? PixelReject::kOutOfRange : o.reject[u];
    o.inverse[u] = ok ? q : kNan;
    o.depth[u] = ok ? z : kNan;
    o.sigma[u] = ok ? z * z * (slope < 0 ? -slope : slope) * m.sigma_rad[i] : kNan;
    o.wrapped[u] = phi;
    const int order = turns - (phi < 0 ? 1 : 0);
    o.order[u] = ok & (order >= 0) & (order < kNoOrder) ? static_cast<std::uint8_t>(order) : kNoOrder;
  }
}

}  // namespace

void make_surface(const PhaseMaps& maps, const PolarityMaps& polarity, const RayDepth& rays, float fourth_rad,
                  Map<float>& inverse_depth, DecodedBurst& out) {
  const auto width = static_cast<std::size_t>(rays.width);
  for (std::size_t v = 0; v < static_cast<std::size_t>(rays.height); ++v) {
    const std::size_t at = v * width;
    solve_row(maps, polarity, rays, fourth_rad, at, width,
              {&inverse_depth[at], &out.patch.depth_mm[at], &out.patch.sigma_mm[at], &out.phase_rad[at], &out.order[at],
               &out.reject[at]});
    for (std::size_t i = at; i < at + width; ++i) {
      const float z = out.patch.depth_mm[i];
      out.patch.points[i] = Vec3f(rays.rays.x[i] * z, rays.rays.y[i] * z, z);
    }
  }
}

}  // namespace enamel::algo
