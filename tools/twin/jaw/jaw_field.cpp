#include "tools/twin/jaw/jaw_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tools/twin/surface/noise.hpp"

namespace enamel::twin {
namespace {

constexpr double kTableMm = 0.25;
constexpr double kReachMm = 3.5;  // beyond a tooth's outline its field is no longer asked

}  // namespace

ArchCoordinates::ArchCoordinates(const Arch& arch) {
  constexpr double kHalfX = 46, kFront = 14, kBack = -62, kSpan = 68, kStep = 0.5;
  x0_ = -kHalfX;
  y0_ = kBack;
  nx_ = static_cast<int>(2 * kHalfX / kTableMm) + 2;
  ny_ = static_cast<int>((kFront - kBack) / kTableMm) + 2;
  std::vector<Eigen::Vector2d> points;
  for (double s = -kSpan; s <= kSpan; s += kStep) points.push_back(arch.point(s));
  s_.reserve(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_));
  n_.reserve(s_.capacity());
  for (int j = 0; j < ny_; ++j) {
    for (int i = 0; i < nx_; ++i) {
      const Eigen::Vector2d p(x0_ + i * kTableMm, y0_ + j * kTableMm);
      std::size_t best = 0;
      for (std::size_t k = 1; k < points.size(); ++k) {
        if ((points[k] - p).squaredNorm() < (points[best] - p).squaredNorm()) best = k;
      }
      double s = -kSpan + kStep * static_cast<double>(best);
      for (int round = 0; round < 3; ++round) s += arch.tangent(s).dot(p - arch.point(s));
      s_.push_back(static_cast<float>(s));
      n_.push_back(static_cast<float>(arch.buccal(s).dot(p - arch.point(s))));
    }
  }
}

ArchCoordinates::At ArchCoordinates::at(double x, double y) const {
  const double fx = std::clamp((x - x0_) / kTableMm, 0.0, nx_ - 1.001);
  const double fy = std::clamp((y - y0_) / kTableMm, 0.0, ny_ - 1.001);
  const auto i = static_cast<std::size_t>(fx), j = static_cast<std::size_t>(fy);
  const double u = fx - static_cast<double>(i), v = fy - static_cast<double>(j);
  const std::size_t k = j * static_cast<std::size_t>(nx_) + i, up = k + static_cast<std::size_t>(nx_);
  const auto blend = [&](const std::vector<float>& t) {
    const double a = static_cast<double>(t[k]), b = static_cast<double>(t[k + 1]);
    const double c = static_cast<double>(t[up]), d = static_cast<double>(t[up + 1]);
    return (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
  };
  return {blend(s_), blend(n_)};
}

JawField::JawField(Dentition dentition, JawSide side, std::uint64_t seed, Inside inside)
    : dentition_(std::move(dentition)),
      side_(side),
      seed_(seed),
      inside_(inside),
      arch_(dentition_.shape),
      coordinates_(arch_) {}

/// The alveolar ridge as a height over the arch plane: a crest below the gum margin, flanks down to the vestibule
/// outside and to floor or palate inside.
double JawField::ridge(const ArchCoordinates::At& a, const Eigen::Vector3d& p) const {
  const double half = 3.0 + 1.9 * smooth_step(std::abs(a.s), 12.0, 34.0);
  const double out = std::abs(a.n) - half;
  double height = -0.9;
  if (a.n >= 0) {
    height -= 8.0 * smooth_step(out, -2.0, 8.0);
  } else if (side_ == JawSide::kLower) {
    height -= 7.5 * smooth_step(out, -2.0, 7.0);
  } else {
    height -= 9.5 * smooth_step(out, -2.0, 13.0);
    // Rugae: transverse folds of the front palate.
    double front = 1.0 - smooth_step(std::abs(a.s), 14.0, 26.0);
    if (inside_ == Inside::kVault) front *= smooth_step(std::abs(p.x()), 0.6, 2.2);  // none on the seam
    height += 0.35 * front * smooth_step(out, 0.5, 2.5) * std::sin(2.2 * out + 0.8 * std::sin(0.5 * a.s));
  }
  height -= 1.2 * smooth_step(std::abs(a.s), 52.0, 66.0);  // behind the last molar
  height += 0.10 * value_noise(p / 2.6, seed_ ^ 0x67756DULL);
  constexpr double kFlankScale = 0.72;
  return kFlankScale * (p.z() - height);
}

/// Gum that clings to a neck: the neck's outline widened, cut off at a margin that rises to a papilla between the teeth
/// and dips into a sulcus at the enamel.
double JawField::collar(const PlacedTooth& t, const Eigen::Vector3d& q, double side) const {
  const ToothForm& f = t.form;
  const double u = std::abs(q.x()) / (0.5 * f.mesiodistal);
  constexpr double kRiseFrom = 0.45, kRiseTo = 1.15, kSulcusMm = 0.35, kSulcusWidthMm = 0.2;
  const double papilla = std::min(3.2, 0.40 * f.height);
  const double outside = std::max(side, 0.0) / kSulcusWidthMm;
  const double dip = kSulcusMm * std::exp(-outside * outside);
  const double margin = 0.35 + papilla * smooth_step(u, kRiseFrom, kRiseTo) - dip;
  // Height over a sloping margin to distance from it.
  const double x = std::clamp((u - kRiseFrom) / (kRiseTo - kRiseFrom), 0.0, 1.0);
  const double rise = papilla * 6.0 * x * (1.0 - x) / (kRiseTo - kRiseFrom) * 2.0 / f.mesiodistal;
  const double fall = 2.0 * outside * dip / kSulcusWidthMm;
  const double scale = 1.0 / std::sqrt(1.0 + rise * rise + fall * fall);
  const double thickness = 0.95 - 0.15 * smooth_step(u, 0.5, 1.0);
  constexpr double kMarginRound = 0.9;
  return smooth_max(side - thickness, scale * (q.z() - margin), kMarginRound);
}

JawField::Sample JawField::sample(const Eigen::Vector3d& p) const {
  const auto a = coordinates_.at(p.x(), p.y());
  double gum = ridge(a, p);
  double teeth = std::numeric_limits<double>::max();
  double groove = 0, far = std::numeric_limits<double>::max();
  for (const auto& t : dentition_.teeth) {
    const double reach = 0.5 * std::max(t.form.mesiodistal, t.form.buccolingual) + kReachMm;
    const double dx = p.x() - t.origin.x(), dy = p.y() - t.origin.y();
    const double d = std::sqrt(dx * dx + dy * dy) - reach;
    // Leaning crowns stray from their origin by at most 1.5 mm; outside `reach` the gap is at least this:
    if (d > 0) {
      far = std::min(far, d + kReachMm - 1.5);
      continue;
    }
    const Eigen::Vector3d q = t.R.transpose() * (p - t.origin);
    const ToothField field = evaluate_tooth(t.form, q);
    if (field.crown < teeth) {
      teeth = field.crown;
      groove = field.groove;
    }
    gum = smooth_min(gum, collar(t, q, field.side), 2.2);
  }
  Sample out;
  if (teeth > kReachMm) teeth = std::min(teeth, far);
  if (std::abs(teeth) < 0.5) teeth += 0.022 * value_noise(p / 1.1, seed_ ^ 0x746FULL);
  if (std::abs(gum) < 0.5) gum += 0.030 * value_noise(p / 0.9, seed_ ^ 0x6775ULL);
  out.value = std::min(teeth, gum);
  out.enamel = smooth_step(gum - teeth, -0.05, 0.05);
  out.groove = groove;
  return out;
}

}  // namespace enamel::twin
