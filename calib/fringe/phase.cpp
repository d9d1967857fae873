#include "calib/fringe/phase.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace enamel::calib {
namespace {

constexpr double kTau = 2 * std::numbers::pi;
constexpr double kMaxSigma_rad = 0.15;
constexpr double kAgreement = 0.25;  // of the finer period

struct Phase {
  double turns = 0;  // in [0, 1)
  double amplitude_dn = 0;
  double mean_dn = 0;
};

Phase phase_at(const FringeLevel& level, std::size_t i) {
  const double i0 = static_cast<double>(level.frames[0][i]), i1 = static_cast<double>(level.frames[1][i]);
  const double i2 = static_cast<double>(level.frames[2][i]), i3 = static_cast<double>(level.frames[3][i]);
  const double turns = std::atan2(i3 - i1, i0 - i2) / kTau;
  return {turns < 0 ? turns + 1 : turns, 0.5 * std::hypot(i3 - i1, i0 - i2), 0.25 * (i0 + i1 + i2 + i3)};
}

}  // namespace

Result<CoordinateMap> decode_coordinate(std::span<const FringeLevel> levels, int side_px, const PixelNoise& noise) {
  if (levels.empty() || levels.front().cycles != 1)
    return fail(ErrorCode::kCalibrationFolder, "the fringes must begin with one period across the projector");
  const int width = levels.front().frames[0].width(), height = levels.front().frames[0].height();
  for (const FringeLevel& level : levels) {
    for (const auto& frame : level.frames) {
      if (frame.width() != width || frame.height() != height)
        return fail(ErrorCode::kCalibrationFolder, "the fringe frames differ in size");
    }
  }
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  CoordinateMap out{Map<float>(width, height, kNone), Map<float>(width, height, kNone)};
  for (std::size_t i = 0; i < out.value_px.size(); ++i) {
    Phase phase = phase_at(levels[0], i);
    double turns = phase.turns;
    bool agrees = true;
    for (std::size_t l = 1; l < levels.size(); ++l) {
      phase = phase_at(levels[l], i);
      const double predicted = turns * levels[l].cycles / levels[l - 1].cycles;
      const double order = std::round(predicted - phase.turns);
      turns = order + phase.turns;
      agrees = agrees && std::abs(turns - predicted) < kAgreement;
    }
    if (!agrees || !(phase.amplitude_dn > 0)) continue;
    // sigma_phi = sqrt(2/4) sigma / B
    const double variance = 0.5 * noise.variance(phase.mean_dn) / (phase.amplitude_dn * phase.amplitude_dn);
    if (!(variance < kMaxSigma_rad * kMaxSigma_rad)) continue;
    const double period_px = static_cast<double>(side_px) / levels.back().cycles;
    out.value_px[i] = static_cast<float>(turns * period_px);
    out.variance_px2[i] = static_cast<float>(variance * (period_px / kTau) * (period_px / kTau));
  }
  return out;
}

}  // namespace enamel::calib
