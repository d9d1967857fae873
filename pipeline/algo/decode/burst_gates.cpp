#include "pipeline/algo/decode/burst_gates.hpp"

#include <cmath>
#include <numbers>

#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

constexpr float kTolerance = 0.25F;  ///< of B: motion of 0.1 rad a frame with a flip's blur stays below
constexpr float kNoiseSigmas = 6;    ///< 3 sigma of the residual, whose std is 2 sigma

}  // namespace

double closure_share(const PhaseMaps& maps, const NoiseModel& noise) {
  std::size_t seen = 0, fits = 0;
  const NoiseModel model = noise;
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  for (std::size_t at = 0; at < maps.phase_rad.size(); at += width) {
    const float* __restrict d = &maps.code_dn[at], * __restrict s = &maps.sine_dn[at];
    const float* __restrict b = &maps.modulation_dn[at], * __restrict a = &maps.mean_dn[at];
    const PixelReject* __restrict reject = &maps.reject[at];
    unsigned row_seen = 0, row_fits = 0;
    for (std::size_t u = 0; u < width; ++u) {
      const float gap = std::abs(std::abs(d[u]) - std::abs(s[u]));
      const float limit = kTolerance * b[u] + kNoiseSigmas * root(model.variance(a[u]));
      const unsigned counted =
          static_cast<unsigned>(reject[u] == PixelReject::kNone) & static_cast<unsigned>(d[u] == d[u]);
      row_seen += counted;
      row_fits += counted & static_cast<unsigned>(gap < limit);
    }
    seen += row_seen;
    fits += row_fits;
  }
  return seen > 0 ? static_cast<double>(fits) / static_cast<double>(seen) : 0;
}

double direction_share(const PhaseMaps& maps, const Carrier& carrier) {
  std::size_t seen = 0, follows = 0;
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  for (std::size_t at = 0; at < maps.phase_rad.size(); at += width) {
    const float* __restrict p = &maps.phase_rad[at], * __restrict c = carrier.phase_mid_rad + at;
    const PixelReject* __restrict reject = &maps.reject[at];
    unsigned row_seen = 0, row_follows = 0;
    for (std::size_t u = 0; u + 1 < width; ++u) {
      const unsigned valid = static_cast<unsigned>(reject[u] == PixelReject::kNone) &
                             static_cast<unsigned>(reject[u + 1] == PixelReject::kNone);
      row_seen += valid;
      row_follows += valid & static_cast<unsigned>(wrap_once(p[u + 1] - p[u]) * (c[u + 1] - c[u]) > 0);
    }
    seen += row_seen;
    follows += row_follows;
  }
  return seen > 0 ? static_cast<double>(follows) / static_cast<double>(seen) : 0;
}

float max_code_turn_rad(double code_ratio) { return static_cast<float>(std::numbers::pi / (3 * code_ratio)); }

}  // namespace enamel::algo
