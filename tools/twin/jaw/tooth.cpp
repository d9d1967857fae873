#include "tools/twin/jaw/tooth.hpp"

#include <algorithm>
#include <cmath>

namespace enamel::twin {
namespace {

/// Catmull-Rom through the five knots; below the neck the root tapers slowly, above the top the last value holds.
double at_height(const Profile& p, double h, double root_taper) {
  if (h <= 0) return p[0] + root_taper * h;
  if (h >= 1) return p[4];
  const double x = 4.0 * h;
  const auto i = std::min<std::size_t>(static_cast<std::size_t>(x), 3);
  const double t = x - static_cast<double>(i);
  const double p0 = i == 0 ? p[0] : p[i - 1], p1 = p[i], p2 = p[i + 1], p3 = i == 3 ? p[4] : p[i + 2];
  return p1 + 0.5 * t * (p2 - p0 + t * (2 * p0 - 5 * p1 + 4 * p2 - p3 + t * (3 * (p1 - p2) + p3 - p0)));
}

/// Signed distance (first order) to the super-ellipse |x/a|^p + |y/b|^p = 1, p = 3 (square) or 2.5.
double outline(double x, double y, double a, double b, bool square) {
  constexpr double kTiny = 1e-9;
  const double u = std::abs(x) / a + kTiny, v = std::abs(y) / b + kTiny;
  const double up = square ? u * u : u * std::sqrt(u), vp = square ? v * v : v * std::sqrt(v);
  const double q = up * u + vp * v;
  const double rho = square ? std::cbrt(q) : std::pow(q, 0.4);
  const double scale = rho / q;  // d rho / d u = u^(p-1) rho / q
  const double gx = up * scale / a, gy = vp * scale / b;
  return (rho - 1.0) / std::sqrt(gx * gx + gy * gy);
}

double bump(double x, double centre, double width) {
  const double d = (x - centre) / width;
  return std::exp(-d * d);
}

/// Shovel shape: the tongue side of front teeth is hollow between marginal ridges, above the cingulum.
double lingual_hollow(const ToothForm& f, double x, double a, double h) {
  const double span = f.kind == ToothKind::kCanine ? 0.45 : 0.62;
  const double depth = f.kind == ToothKind::kCanine ? 0.22 : 0.42;
  const double ridge = 1.0 - smooth_step(std::abs(x) / a, 0.55 * span, 1.25 * span);
  return depth * ridge * smooth_step(h, 0.28, 0.5) * (1.0 - 0.6 * smooth_step(h, 0.8, 1.0));
}

double side_distance(const ToothForm& f, const Eigen::Vector3d& p) {
  const double h = p.z() / f.height;
  const double a = std::max(0.3, 0.5 * f.mesiodistal * at_height(f.width, h, 0.12));
  double b = std::max(0.25, 0.5 * f.buccolingual * at_height(f.thickness, h, 0.1));
  double y = p.y() - 0.5 * f.buccolingual * at_height(f.lean, h, 0.0);
  const bool front = f.kind == ToothKind::kIncisor || f.kind == ToothKind::kCanine;
  if (front) {
    if (y < 0) b -= std::min(0.6 * b, lingual_hollow(f, p.x(), a, h));
  } else {
    for (const auto& g : f.side_grooves) {
      const double toward = smooth_step(y * g.side / b, 0.0, 0.7);
      b -= g.depth * toward * bump(p.x(), g.x, 0.75) * smooth_step(h, 0.3, 0.85);
    }
  }
  return outline(p.x(), y, a, b, f.square);
}

struct Top {
  double z, groove;
  double steep;  // 0…1: about a fissure, whose walls are steeper than cusps
};

/// Cusps are rounded cones with a ridge towards the middle of the table; where two meet lies a fissure.
Top posterior_top(const ToothForm& f, const Eigen::Vector3d& p) {
  constexpr double kTipRadius = 0.45;
  constexpr double kCrease = 0.22;
  double first = -1e9, second = -1e9;
  for (const auto& c : f.cusps) {
    const double dx = p.x() - c.x, dy = p.y() - c.y;
    const double r = std::sqrt(dx * dx + dy * dy + kTipRadius * kTipRadius);
    // cos 3 theta about the direction to the centre: one central ridge and two side ridges a cusp.
    const double to = std::sqrt(c.x * c.x + c.y * c.y) + 1e-9;
    const double cosine = -(dx * c.x + dy * c.y) / (r * to);
    const double ripple = 4.0 * cosine * cosine * cosine - 3.0 * cosine;
    const double z = c.z - c.slope * (1.0 - 0.13 * ripple) * (r - kTipRadius);
    if (z > first) {
      second = first;
      first = z;
    } else {
      second = std::max(second, z);
    }
  }
  // Marginal ridges close the table at both ends.
  const double ridge_x = 0.41 * f.mesiodistal;
  for (const double side : {-1.0, 1.0}) {
    const double dx = p.x() - side * ridge_x, dy = p.y();
    const double z = 0.80 * f.height - 0.9 * (std::sqrt(dx * dx + 0.16) - 0.4) - 0.035 * dy * dy;
    if (z > first) {
      second = first;
      first = z;
    } else {
      second = std::max(second, z);
    }
  }
  const double apart = (first - second) / 0.17;
  const double groove = std::exp(-apart * apart);
  return {smooth_max(first, second, kCrease) - 0.26 * groove, groove, std::exp(-0.25 * apart * apart)};
}

Top front_top(const ToothForm& f, const Eigen::Vector3d& p) {
  const double x = p.x(), half = 0.5 * f.mesiodistal;
  if (f.kind == ToothKind::kCanine) {
    const double tip = -0.06 * f.mesiodistal;  // the mesial slope is the shorter one
    return {f.height - 0.62 * (std::sqrt((x - tip) * (x - tip) + 0.25) - 0.5), 0, 0};
  }
  const double u = x / half;
  const double mamelons = 0.07 * std::cos(3.0 * 3.14159265358979 * u);
  return {f.height - 0.25 * u * u - 0.45 * smooth_step(u, 0.45, 1.1) + mamelons, 0, 0};
}

/// Ground for a crown: a tapered stump on a shoulder. The shoulder lies above the gum and rises with it between teeth.
ToothField prepared(const ToothForm& f, const Eigen::Vector3d& p) {
  constexpr double kShoulderMm = 1.1, kTaper = 0.1, kAboveGumMm = 1.3, kGroundOffMm = 1.4, kStumpRoundMm = 0.5;
  constexpr double kInnerRoundMm = 0.3;
  const double between = smooth_step(std::abs(p.x()) / (0.5 * f.mesiodistal), 0.45, 1.15);
  const double line = kAboveGumMm + std::min(3.2, 0.40 * f.height) * between;
  ToothField out;
  out.side = side_distance(f, p);
  const double over = p.z() - line;
  const double foot = smooth_max(out.side, 0.8 * over, std::max(f.finish_edge_mm, 1e-3));
  const double wall = out.side + kShoulderMm + kTaper * std::max(over, 0.0);
  const double stump = smooth_max(wall, p.z() - (f.height - kGroundOffMm), kStumpRoundMm);
  out.crown = smooth_min(foot, stump, kInnerRoundMm);
  return out;
}

ToothField scan_body(const ToothForm& f, const Eigen::Vector3d& p) {
  ToothField out;
  out.side = std::hypot(p.x(), p.y()) - 0.5 * f.mesiodistal;
  constexpr double kFlatFromMm = 3;  // the flat is on the upper part
  const double cut = std::min(p.y() - f.flat_mm, p.z() - kFlatFromMm);
  out.crown = std::max({out.side, p.z() - f.height, cut});
  return out;
}

}  // namespace

ToothField evaluate_tooth(const ToothForm& form, const Eigen::Vector3d& p) {
  if (form.work == ToothWork::kPrepared) return prepared(form, p);
  if (form.work == ToothWork::kScanBody) return scan_body(form, p);
  ToothField out;
  out.side = side_distance(form, p);
  const bool front = form.kind == ToothKind::kIncisor || form.kind == ToothKind::kCanine;
  const Top top = front ? front_top(form, p) : posterior_top(form, p);
  // Vertical distance to distance: cusps fall by about 0.65, the walls of fissures by up to 2.7.
  const double scale = 0.84 / (1.0 + 1.4 * top.steep);
  out.crown = smooth_max(out.side, scale * (p.z() - top.z), form.rounding);
  out.groove = top.groove * smooth_step(-out.side, 0.3, 1.0);
  return out;
}

}  // namespace enamel::twin
