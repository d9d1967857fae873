#include "calib/judge/ceramic_tile.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "calib/judge/plane_fit.hpp"

namespace enamel::calib {
namespace {

constexpr int kSquare_px = 16;        // layout: noise of a pixel, and its lobes' texture, averaged
constexpr int kFewestBursts = 5;      // chosen: by judgement; less says nothing of their scatter
constexpr double kBorder_mm = 1;      // chosen: light of enamel spreads by 0.4 mm, two and a half of it
constexpr double kFlat_um = 5;        // chosen: by judgement, what grinding leaves and a calibration may bow
constexpr double kUnsureShare = 0.1;  // chosen: by judgement, of a share at an edge: 3 um of a tooth
constexpr std::size_t kFewestSquares = 12;
constexpr std::size_t kNodes = 9;

using Basis = Eigen::Matrix<double, kNodes, 1>;

/// Parabolas through -1, 0, 1 in both directions: what each node adds at a place.
Basis basis_at(double across, double down) {
  const auto parabolas = [](double s) {
    return std::array<double, 3>{0.5 * s * (s - 1), 1 - s * s, 0.5 * s * (s + 1)};
  };
  const auto u = parabolas(across), v = parabolas(down);
  Basis out;
  for (std::size_t i = 0; i < kNodes; ++i) out[static_cast<Eigen::Index>(i)] = v[i / 3] * u[i % 3];
  return out;
}

struct Mean {
  int u = 0, v = 0;  ///< first pixel
  Vec3d place = Vec3d::Zero();
  double enamel_mm = 0;
};

/// Squares whose pixels are nearly all measured and all of one kind; `frame` and `ceramic` by it.
struct Squares {
  std::vector<Mean> frame, ceramic;
};

/// Of one square; nothing where it is torn.
std::optional<Mean> mean_of(const TileView& view, int u0, int v0, int& opaque, int& measured) {
  Mean out{u0, v0};
  opaque = measured = 0;
  for (int v = v0; v < v0 + kSquare_px; ++v) {
    for (int u = u0; u < u0 + kSquare_px; ++u) {
      const Vec3f& p = view.points(u, v);
      const float enamel = view.enamel_mm(u, v);
      if (!p.allFinite() || !std::isfinite(enamel)) continue;
      out.place += p.cast<double>(), out.enamel_mm += static_cast<double>(enamel);
      ++measured, opaque += enamel == 0 ? 1 : 0;
    }
  }
  if (measured < kSquare_px * kSquare_px * 3 / 4) return std::nullopt;
  out.place /= measured, out.enamel_mm /= measured;
  return out;
}

enum class Kind : std::uint8_t { kMixed, kFrame, kCeramic };

Squares squares_of(const TileView& view) {
  const int across = view.points.width() / kSquare_px, down = view.points.height() / kSquare_px;
  std::vector<Kind> kind(static_cast<std::size_t>(across) * static_cast<std::size_t>(down), Kind::kMixed);
  std::vector<std::optional<Mean>> mean(kind.size());
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(across) + static_cast<std::size_t>(x);
  };
  for (int y = 0; y < down; ++y) {
    for (int x = 0; x < across; ++x) {
      int opaque = 0, measured = 0;
      mean[at(x, y)] = mean_of(view, x * kSquare_px, y * kSquare_px, opaque, measured);
      if (!mean[at(x, y)]) continue;
      if (opaque == measured) kind[at(x, y)] = Kind::kFrame;
      if (opaque * 20 < measured) kind[at(x, y)] = Kind::kCeramic;
    }
  }
  // Light of the ceramic creeps into the frame's rim, and its own rim is darker.
  const int margin = std::max(1, static_cast<int>(std::ceil(kBorder_mm / view.pixel_mm / kSquare_px)));
  Squares out;
  for (int y = 0; y < down; ++y) {
    for (int x = 0; x < across; ++x) {
      const Kind own = kind[at(x, y)];
      bool alone = own != Kind::kMixed;
      for (int b = std::max(0, y - margin); b <= std::min(down - 1, y + margin); ++b)
        for (int a = std::max(0, x - margin); a <= std::min(across - 1, x + margin); ++a)
          alone = alone && kind[at(a, b)] == own;
      if (alone) (own == Kind::kFrame ? out.frame : out.ceramic).push_back(*mean[at(x, y)]);
    }
  }
  return out;
}

/// Of camera z, beyond the plane along the point's own ray.
double beyond_mm(const PlaneFit& plane, const Vec3d& p) {
  return p.z() * (1 - plane.normal.dot(plane.middle) / plane.normal.dot(p));
}

double rms_um(const std::vector<double>& mm) {
  double squares = 0;
  for (const double x : mm) squares += x * x;
  return mm.empty() ? 0 : 1e3 * std::sqrt(squares / static_cast<double>(mm.size()));
}

constexpr std::array<const char*, kNodes> kPlaces = {"top left", "top",         "top right", "left",        "middle",
                                                     "right",    "bottom left", "bottom",    "bottom right"};

}  // namespace

bool CeramicTile::add(const TileView& view) {
  const Squares squares = squares_of(view);
  if (squares.frame.size() < kFewestSquares || squares.ceramic.size() < kFewestSquares) return false;
  const PlaneFit plane = plane_through(squares.frame);
  for (const Mean& m : squares.frame) frame_mm_.push_back(beyond_mm(plane, m.place));
  const double half_width = 0.5 * (view.points.width() - 1), half_height = 0.5 * (view.points.height() - 1);
  for (const Mean& m : squares.ceramic) {
    const double middle = 0.5 * (kSquare_px - 1);
    squares_.push_back({(m.u + middle) / half_width - 1, (m.v + middle) / half_height - 1, beyond_mm(plane, m.place),
                        m.enamel_mm, bursts_});
  }
  ++bursts_;
  return true;
}

Result<TileFit> CeramicTile::solve() const {
  if (bursts_ < kFewestBursts) {
    return fail(ErrorCode::kCalibrationPoses,
                fmt::format("{} bursts show frame and ceramic, {} are needed: hold still, both in view", bursts_,
                            kFewestBursts));
  }
  TileFit fit;
  if (fit.frame_um = rms_um(frame_mm_); fit.frame_um > kFlat_um) {
    return fail(ErrorCode::kCalibrationRefused,
                fmt::format("the frame is {:.1f} um off a plane: clean or replace it, or calibrate the probe first",
                            fit.frame_um));
  }
  Eigen::Matrix<double, kNodes, kNodes> normal = Eigen::Matrix<double, kNodes, kNodes>::Zero();
  Basis right = Basis::Zero();
  for (const Square& s : squares_) {
    const Basis row = s.enamel_mm * basis_at(s.across, s.down);
    normal += row * row.transpose(), right += s.off_mm * row;
  }
  const Eigen::LDLT<Eigen::Matrix<double, kNodes, kNodes>> solver(normal);
  const Basis share = solver.solve(right);
  std::vector<double> before, by_enamel, after;
  std::vector<std::array<double, 2>> by_burst(static_cast<std::size_t>(bursts_), {0, 0});
  for (const Square& s : squares_) {
    const double off = s.enamel_mm * share.dot(basis_at(s.across, s.down));
    before.push_back(s.off_mm), by_enamel.push_back(s.off_mm - s.enamel_mm), after.push_back(s.off_mm - off);
    auto& [with, own] = by_burst[static_cast<std::size_t>(s.burst)];
    with += off * s.off_mm, own += off * off;
  }
  fit.before_um = rms_um(before), fit.by_enamel_um = rms_um(by_enamel), fit.after_um = rms_um(after);
  const Basis variance = solver.solve(Eigen::Matrix<double, kNodes, kNodes>::Identity()).diagonal();
  for (std::size_t i = 0; i < kNodes; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double sigma = std::sqrt(std::max(0.0, variance[k])) * 1e-3 * fit.after_um;
    if (!std::isfinite(sigma) || !std::isfinite(share[k]) || sigma > kUnsureShare) {
      return fail(ErrorCode::kCalibrationPoses,
                  fmt::format("too little of the ceramic is seen {} of the picture: move it there", kPlaces[i]));
    }
    if (share[k] < kLeastOfEnamel || share[k] > kMostOfEnamel) {
      return fail(
          ErrorCode::kCalibrationRefused,
          fmt::format("what looks translucent lies {:.2g} times as deep as enamel would: is it a tooth-like ceramic, "
                      "flush with its frame?",
                      share[k]));
    }
    fit.light.of_enamel[i / 3][i % 3] = share[k];
  }
  double squares = 0;
  for (const auto& [with, own] : by_burst) squares += own > 0 ? (with / own - 1) * (with / own - 1) : 0;
  fit.light.sigma = std::sqrt(squares / (bursts_ - 1) / bursts_);
  fit.light.bursts = bursts_;
  return fit;
}

}  // namespace enamel::calib
