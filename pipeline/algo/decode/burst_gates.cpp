#include "pipeline/algo/decode/burst_gates.hpp"

#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

constexpr float kTolerance = 0.25F;  ///< of B: motion of 0.1 rad a frame with a flip's blur stays below
constexpr float kNoiseSigmas = 6;    ///< 3 sigma of the residual, whose std is 2 sigma

}  // namespace

double closure_share(const PhaseMaps& maps, const NoiseModel& noise) {
  std::size_t seen = 0, fits = 0;
  for (std::size_t i = 0; i < maps.phase_rad.size(); ++i) {
    const float d = maps.code_dn[i], s = maps.sine_dn[i];
    const bool counted = (maps.reject[i] == PixelReject::kNone) & (d == d);
    const float ad = d < 0 ? -d : d, as = s < 0 ? -s : s;
    const float gap = ad > as ? ad - as : as - ad;
    const float limit = kTolerance * maps.modulation_dn[i] + kNoiseSigmas * sqrt_poly(noise.variance(maps.mean_dn[i]));
    seen += counted ? 1 : 0;
    fits += counted & (gap < limit) ? 1 : 0;
  }
  return seen > 0 ? static_cast<double>(fits) / static_cast<double>(seen) : 0;
}

}  // namespace enamel::algo
