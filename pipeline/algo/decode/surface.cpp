#include "pipeline/algo/decode/surface.hpp"

#include <array>
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

/// The ripple's error in float, for Clenshaw's recursion over the angle 4 phi.
struct Ripple {
  std::array<float, kRippleTerms> cosine{}, sine{};

  explicit Ripple(const PhaseRipple& r) {
    for (std::size_t m = 0; m < kRippleTerms; ++m) {
      cosine[m] = static_cast<float>(r.cosine[m]);
      sine[m] = static_cast<float>(r.sine[m]);
    }
  }

  /// From the vector (c, s) of phi, which needs no trigonometry.
  [[nodiscard]] float error_rad(float c, float s) const noexcept {
    static_assert(kRippleTerms == 4);
    const float inv2 = 1.0F / (c * c + s * s + 1e-6F);
    const float cos2 = (c - s) * (c + s) * inv2, sin2 = 2 * c * s * inv2;
    const float cos4 = 2 * cos2 * cos2 - 1, sin4 = 2 * sin2 * cos2, twice = 2 * cos4;
    const auto clenshaw = [twice](const std::array<float, kRippleTerms>& k, float& b1, float& b2) {
      const float b3 = k[2] + twice * k[3];
      b2 = k[1] + twice * b3 - k[3];
      b1 = k[0] + twice * b2 - b3;
    };
    float c1 = 0, c2 = 0, s1 = 0, s2 = 0;
    clenshaw(cosine, c1, c2);
    clenshaw(sine, s1, s2);
    return cos4 * c1 - c2 + sin4 * s1;
  }
};

void solve_row(const PhaseMaps& m, const Map<std::int16_t>& turns_of, const RayDepth& rays, const Ripple& ripple_of,
               std::size_t at, std::size_t width, const RowOut& o) {
  const Ripple ripple = ripple_of;  // a copy cannot alias what is written
  const float q_near = 1.0F / rays.near_mm, q_far = 1.0F / rays.far_mm;
  const float phase_low = rays.min_phase_rad, phase_high = rays.max_phase_rad;
  const float* __restrict phase = &m.phase_rad[at], * __restrict cosine = &m.cosine_dn[at];
  const float* __restrict sine = &m.sine_dn[at], * __restrict sigma = &m.sigma_rad[at];
  const std::int16_t* __restrict turn = &turns_of[at];
  const float* __restrict mid = &rays.phase_mid_rad[at], * __restrict c0 = &rays.c0[at], * __restrict c1 = &rays.c1[at];
  const float* __restrict c2 = &rays.c2[at], * __restrict c3 = &rays.c3[at];
  float* __restrict inverse = o.inverse, * __restrict depth = o.depth, * __restrict sigma_mm = o.sigma;
  float* __restrict wrapped = o.wrapped;
  std::uint8_t* __restrict order = o.order;
  PixelReject* __restrict reject = o.reject;
  ENAMEL_INDEPENDENT
  for (std::size_t u = 0; u < width; ++u) {
    const float raw = phase[u] - ripple.error_rad(cosine[u], sine[u]);
    const int turns = turn[u] + static_cast<int>(raw >= kPiF) - static_cast<int>(raw < -kPiF);
    const float phi = select(raw >= kPiF, raw - kTwoPiF, select(raw < -kPiF, raw + kTwoPiF, raw));
    const float absolute = phi + kTwoPiF * static_cast<float>(turns);
    const float t = absolute - mid[u];
    const float q = c0[u] + t * (c1[u] + t * (c2[u] + t * c3[u]));
    const float slope = c1[u] + t * (2 * c2[u] + t * (3 * c3[u]));
    const unsigned inside = static_cast<unsigned>(q <= q_near) & static_cast<unsigned>(q >= q_far) &
                            static_cast<unsigned>(absolute > phase_low) & static_cast<unsigned>(absolute < phase_high);
    const auto was = static_cast<unsigned>(reject[u]);
    const bool ok = (inside == 1) & (was == 0);
    const float z = 1.0F / select(ok, q, 1.0F);
    reject[u] =
        static_cast<PixelReject>(was == 0 ? (1 - inside) * static_cast<unsigned>(PixelReject::kOutOfRange) : was);
    inverse[u] = select(ok, q, kNan);
    depth[u] = select(ok, z, kNan);
    sigma_mm[u] = select(ok, z * z * std::abs(slope) * sigma[u], kNan);
    wrapped[u] = phi;
    const int floor_order = turns - static_cast<int>(phi < 0);
    const bool known = ok & (floor_order >= 0) & (floor_order < static_cast<int>(kNoOrder));
    order[u] = static_cast<std::uint8_t>(known ? floor_order : static_cast<int>(kNoOrder));
  }
}

}  // namespace

void make_surface(const PhaseMaps& maps, const Map<std::int16_t>& turn, const RayDepth& rays, const PhaseRipple& ripple,
                  Map<float>& inverse_depth, DecodedBurst& out) {
  const auto width = static_cast<std::size_t>(rays.width);
  for (std::size_t v = 0; v < static_cast<std::size_t>(rays.height); ++v) {
    const std::size_t at = v * width;
    solve_row(maps, turn, rays, Ripple(ripple), at, width,
              {&inverse_depth[at], &out.patch.depth_mm[at], &out.patch.sigma_mm[at], &out.phase_rad[at], &out.order[at],
               &out.reject[at]});
    for (std::size_t i = at; i < at + width; ++i) {
      const float z = out.patch.depth_mm[i];
      out.patch.points[i] = Vec3f(rays.rays.x[i] * z, rays.rays.y[i] * z, z);
    }
  }
}

void make_inverse_depth(const PhaseMaps& maps, const Map<std::int16_t>& turns, const RayDepth& rays,
                        Map<float>& inverse_depth) {
  const float q_near = 1.0F / rays.near_mm, q_far = 1.0F / rays.far_mm;
  const float* __restrict phase = maps.phase_rad.pixels().data();
  const std::int16_t* __restrict turn = turns.pixels().data();
  const PixelReject* __restrict reject = maps.reject.pixels().data();
  const float* __restrict mid = rays.phase_mid_rad.data(), * __restrict c0 = rays.c0.data();
  const float* __restrict c1 = rays.c1.data(), * __restrict c2 = rays.c2.data(), * __restrict c3 = rays.c3.data();
  float* __restrict out = inverse_depth.pixels().data();
  ENAMEL_INDEPENDENT
  for (std::size_t i = 0; i < inverse_depth.size(); ++i) {
    const float t = phase[i] + kTwoPiF * static_cast<float>(turn[i]) - mid[i];
    const float q = c0[i] + t * (c1[i] + t * (c2[i] + t * c3[i]));
    const bool ok = (reject[i] == PixelReject::kNone) & (q <= q_near) & (q >= q_far);
    out[i] = select(ok, q, kNan);
  }
}

}  // namespace enamel::algo
