#include "tools/twin/jaw/ridge.hpp"

#include <algorithm>
#include <cmath>

#include "tools/twin/jaw/strip.hpp"
#include "tools/twin/surface/noise.hpp"

namespace enamel::twin {
namespace {

// derived: robust fit of this swept profile to the 330 ball centres of the edentulous accuracy model of
// github.com/mykakus/Full-Arch-Dental-Model-Prototype-for-Digitization-Accuracy-Evaluation; the half widths are those
// of the fit and 2.3 mm, by which balls of 2.5 mm radius stand out of the flanks. The surface is 0.7 mm from the balls
// (median above the foot).
constexpr ArchShape kShape{25.0, 48.0, 2.6};
constexpr double kHalfFrontMm = 4.2, kHalfBackMm = 6.4;  // crest to the middle of the shoulder
constexpr double kCrestRiseMm = 0.5;                     // from front to back
constexpr double kOuterDropMm = 17.8, kOuterFlankMm = 7.8;
constexpr double kInnerDropMm = 12.7, kInnerFlankMm = 12.2;
constexpr double kShoulderMm = 2.0;  // of the crest, taken by the flank's round beginning
constexpr double kCrownMm = 1.0;     // fall of the crest to its shoulders: highest centres 3 to 5 mm beside the arch
constexpr double kFrontMm = 8, kBackMm = 34;

constexpr double kStripInsideMm = 13, kStripOutsideMm = 11;  // width of the strip
constexpr double kStripLowZ = -19, kStripHighZ = 3;

}  // namespace

RidgeField::RidgeField(double relief_um, std::uint64_t seed)
    : relief_mm_(1e-3 * relief_um), seed_(seed), arch_(kShape), coordinates_(arch_) {}

double RidgeField::profile(const ArchCoordinates::At& a) {
  const double back = smooth_step(std::abs(a.s), kFrontMm, kBackMm);
  const double half = kHalfFrontMm + (kHalfBackMm - kHalfFrontMm) * back;
  const double out = std::abs(a.n) - half;
  const double drop = a.n >= 0 ? kOuterDropMm * smooth_step(out, -kShoulderMm, kOuterFlankMm - kShoulderMm)
                               : kInnerDropMm * smooth_step(out, -kShoulderMm, kInnerFlankMm - kShoulderMm);
  return kCrestRiseMm * back - kCrownMm * smooth_step(std::abs(a.n), 0, half) - drop;
}

/// Mucosa: fine grain, soft unevenness, and transverse folds on the inner flank in front.
double RidgeField::relief(const ArchCoordinates::At& a, const Eigen::Vector3d& p) const {
  constexpr double kGrainMm = 0.9, kWaveMm = 2.6, kWaveToGrain = 3;
  const double in_front = 1.0 - smooth_step(std::abs(a.s), 12.0, 22.0);
  const double on_flank = smooth_step(-a.n, 2.0, 4.5) * smooth_step(std::abs(p.x()), 0.6, 2.2);
  const double folds = kFoldsToRelief * in_front * on_flank * std::sin(2.2 * a.n + 0.8 * std::sin(0.5 * a.s));
  return relief_mm_ * (value_noise(p / kGrainMm, seed_ ^ 0x677261ULL) +
                       kWaveToGrain * value_noise(p / kWaveMm, seed_ ^ 0x776176ULL) + folds);
}

double RidgeField::value(const Eigen::Vector3d& p) const {
  const auto a = coordinates_.at(p.x(), p.y());
  constexpr double kHalfMm = 0.05;
  const double slope = (profile({a.s, a.n + kHalfMm}) - profile({a.s, a.n - kHalfMm})) / (2 * kHalfMm);
  const double distance = (p.z() - profile(a)) / std::sqrt(1.0 + slope * slope);
  constexpr double kReliefReachMm = 1.0;  // the relief matters near the surface only
  return std::abs(distance) < kReliefReachMm ? distance - relief(a, p) : distance;
}

Ridge make_ridge(const RidgeConfig& config, std::uint64_t seed) {
  const RidgeField field(config.relief_um, seed);
  Strip strip{-kRidgeEndMm, kRidgeEndMm, kStripInsideMm, kStripOutsideMm, kStripLowZ, kStripHighZ};
  if (config.to_mm > config.from_mm) {
    strip.from = config.from_mm;
    strip.to = config.to_mm;
  }
  Ridge ridge{kShape, mesh_strip(strip, field.arch(), field.coordinates(), {config.max_edge_mm, RidgeField::kLipschitz},
                                 [&](const Eigen::Vector3d& p) { return field.value(p); })};
  std::fill(ridge.mesh.albedo.begin(), ridge.mesh.albedo.end(), static_cast<float>(config.albedo));
  refine_edges(ridge.mesh, config.max_edge_mm);
  return ridge;
}

}  // namespace enamel::twin
