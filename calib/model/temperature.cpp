#include "calib/model/temperature.hpp"

#include <algorithm>
#include <cmath>

#include "calib/model/rig.hpp"

namespace enamel::calib {
namespace {

using Matrix3 = std::array<std::array<double, 3>, 3>;

/// Rodrigues' formula.
Matrix3 rotation_of(const std::array<double, 3>& w) {
  const double angle = std::hypot(w[0], w[1], w[2]);
  const double s = angle > 0 ? std::sin(angle) / angle : 1;
  const double half = 0.5 * angle;
  const double c = angle > 0 ? 0.5 * std::pow(std::sin(half) / half, 2) : 0.5;  // (1 - cos) / angle²
  const Matrix3 cross{{{0, -w[2], w[1]}, {w[2], 0, -w[0]}, {-w[1], w[0], 0}}};
  Matrix3 r{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      double squared = 0;
      for (std::size_t k = 0; k < 3; ++k) squared += cross[i][k] * cross[k][j];
      r[i][j] = (i == j ? 1 : 0) + s * cross[i][j] + c * squared;
    }
  }
  return r;
}

void drift(LensValues& lens, const LensDrift& per_k, double kelvins) {
  lens.fx += per_k.fx * kelvins;
  lens.fy += per_k.fy * kelvins;
  lens.cx += per_k.cx * kelvins;
  lens.cy += per_k.cy * kelvins;
}

}  // namespace

Rig rig_at(const Rig& rig, double temp_c) {
  Rig out = rig;
  if (!rig.temperature) return out;
  const TemperatureTerms& t = *rig.temperature;
  const double kelvins = std::clamp(temp_c, t.range_c[0], t.range_c[1]) - t.reference_c;
  drift(out.camera, t.camera, kelvins);
  drift(out.projector, t.projector, kelvins);
  const Matrix3 turn =
      rotation_of({t.rotation_rad[0] * kelvins, t.rotation_rad[1] * kelvins, t.rotation_rad[2] * kelvins});
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      double sum = 0;
      for (std::size_t k = 0; k < 3; ++k) sum += turn[i][k] * rig.T_proj_cam[k][j];
      out.T_proj_cam[i][j] = sum;
    }
    out.T_proj_cam[i][3] += t.translation_mm[i] * kelvins;
  }
  return out;
}

std::optional<double> kelvins_beyond(const Rig& rig, double temp_c) {
  if (rig.temperature) {
    const auto& [low, high] = rig.temperature->range_c;
    return std::max({0.0, low - temp_c, temp_c - high});
  }
  if (rig.temp_c) return std::abs(temp_c - *rig.temp_c);
  return std::nullopt;
}

}  // namespace enamel::calib
