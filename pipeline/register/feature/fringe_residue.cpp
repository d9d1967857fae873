#include "pipeline/register/feature/fringe_residue.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "calib/model/lens.hpp"

namespace enamel::pipeline {
namespace {

using Basis = Eigen::Matrix<double, 5, 1>;  // 1, cos, sin, cos of the double, sin of it

Basis basis_of(float phase) {
  const auto phi = static_cast<double>(phase);
  Basis out;
  out << 1, std::cos(phi), std::sin(phi), std::cos(2 * phi), std::sin(2 * phi);
  return out;
}

struct Moments {
  Eigen::Matrix<double, 5, 5> A = Eigen::Matrix<double, 5, 5>::Zero();
  Basis b = Basis::Zero();
  void add(const Moments& other, double weight) {
    A += weight * other.A;
    b += weight * other.b;
  }
};

/// Moments of each tile.
Map<Moments> moments_of(const Map<float>& brightness, const Map<float>& phase, int tile_px) {
  const auto tiles = [&](int px) { return (px + tile_px - 1) / tile_px; };
  Map<Moments> out(tiles(phase.width()), tiles(phase.height()));
  for (int v = 0; v < phase.height(); ++v) {
    for (int u = 0; u < phase.width(); ++u) {
      const float value = brightness(u, v);
      if (!std::isfinite(value) || !std::isfinite(phase(u, v))) continue;
      const Basis basis = basis_of(phase(u, v));
      Moments& tile = out(u / tile_px, v / tile_px);
      tile.A += basis * basis.transpose();
      tile.b += static_cast<double>(value) * basis;
    }
  }
  return out;
}

/// Coefficients of each tile, fitted over it and its neighbours.
Map<Basis> fitted(const Map<Moments>& moments) {
  Map<Basis> out(moments.width(), moments.height(), Basis::Zero());
  for (int v = 0; v < moments.height(); ++v) {
    for (int u = 0; u < moments.width(); ++u) {
      Moments around;
      for (int dv = -1; dv <= 1; ++dv) {
        for (int du = -1; du <= 1; ++du) {
          if (moments.contains(u + du, v + dv))
            around.add(moments(u + du, v + dv), 1.0 / ((1 + std::abs(du)) * (1 + std::abs(dv))));
        }
      }
      // A tile without surface has nothing to tell and nothing to be told.
      around.A += 1e-3 * Eigen::Matrix<double, 5, 5>::Identity();
      out(u, v) = around.A.ldlt().solve(around.b);
    }
  }
  return out;
}

/// Between the middles of the tiles.
Basis interpolated(const Map<Basis>& tiles, double u, double v) {
  const int u0 = std::clamp(static_cast<int>(std::floor(u)), 0, std::max(tiles.width() - 2, 0));
  const int v0 = std::clamp(static_cast<int>(std::floor(v)), 0, std::max(tiles.height() - 2, 0));
  const int u1 = std::min(u0 + 1, tiles.width() - 1), v1 = std::min(v0 + 1, tiles.height() - 1);
  const double a = std::clamp(u - u0, 0.0, 1.0), b = std::clamp(v - v0, 0.0, 1.0);
  return (1 - b) * ((1 - a) * tiles(u0, v0) + a * tiles(u1, v0)) + b * ((1 - a) * tiles(u0, v1) + a * tiles(u1, v1));
}

}  // namespace

double FringePhase::operator()(const Vec3f& p) const {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const calib::PatternValues& pattern = rig_.patterns;
  if (!(p.z() > 0) || !(pattern.period_px > 0)) return kNone;
  const auto z = static_cast<double>(p.z());
  const calib::PlanePoint at =
      calib::project_to_projector(rig_, {static_cast<double>(p.x()) / z, static_cast<double>(p.y()) / z}, z);
  return 2 * std::numbers::pi * (pattern.axis_v ? at.y : at.x) / pattern.period_px;
}

void remove_fringes(Map<float>& brightness, const Map<float>& phase, int tile_px) {
  const Map<Basis> tiles = fitted(moments_of(brightness, phase, tile_px));
  const auto tile_of = [&](int px) { return (px + 0.5) / tile_px - 0.5; };
  for (int v = 0; v < phase.height(); ++v) {
    for (int u = 0; u < phase.width(); ++u) {
      if (!std::isfinite(phase(u, v))) continue;
      Basis c = interpolated(tiles, tile_of(u), tile_of(v));
      c[0] = 0;  // the mean is the surface's own
      brightness(u, v) -= static_cast<float>(c.dot(basis_of(phase(u, v))));
    }
  }
}

}  // namespace enamel::pipeline
