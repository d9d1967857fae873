#include "tools/twin/jaw/fault.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/twin/optics/random.hpp"

namespace enamel::twin {
namespace {

constexpr double kFaultMmPerUm = 1e-3;
constexpr std::uint64_t kSpotStream = 7001;

/// Of a dentition in order of arc length: the one of that number on the right, or none.
std::size_t tooth_at(const FaultConfig& fault, const Dentition& d) {
  int number = 0;
  for (std::size_t i = 0; i < d.teeth.size(); ++i)
    if (d.teeth[i].s > 0 && ++number == fault.tooth) return i;
  return d.teeth.size();
}

}  // namespace

void apply_fault(const FaultConfig& fault, Dentition& dentition) {
  const std::size_t at = tooth_at(fault, dentition);
  if (at == dentition.teeth.size()) return;
  ToothForm& form = dentition.teeth[at].form;
  if (fault.is_prepared) {
    form.work = ToothWork::kPrepared;
    form.finish_edge_mm = fault.finish_edge_mm;
  }
  if (!fault.is_scan_body) return;
  form.work = ToothWork::kScanBody;
  form.mesiodistal = form.buccolingual = 2 * (kScanBodyRadiusMm + kFaultMmPerUm * fault.body_error_um);
  form.height = kScanBodyHeightMm;
  form.flat_mm = kScanBodyFlatMm;
}

void move_tooth(const FaultConfig& fault, Dentition& dentition) {
  const std::size_t at = tooth_at(fault, dentition);
  if (at == dentition.teeth.size()) return;
  PlacedTooth& tooth = dentition.teeth[at];
  tooth.origin += kFaultMmPerUm * fault.move_um * tooth.R.col(1);
}

void blacken_spot(const FaultConfig& fault, const Dentition& dentition, std::uint64_t seed, TriSurface& mesh) {
  const std::size_t at = tooth_at(fault, dentition);
  if (!(fault.spot_mm > 0) || at == dentition.teeth.size()) return;
  constexpr double kAside = 0.2;  // of the tooth's size: the spot stays on the biting side
  constexpr float kSoot = 0.002F;
  const PlacedTooth& tooth = dentition.teeth[at];
  const CounterRandom random(seed, kSpotStream);
  const Vec3d local(kAside * tooth.form.mesiodistal * (2 * random.uniform(0) - 1),
                    kAside * tooth.form.buccolingual * (2 * random.uniform(1) - 1), tooth.form.height);
  const Vec3d wanted = tooth.R * local + tooth.origin;
  Vec3d middle = wanted;
  double least = std::numeric_limits<double>::max();
  for (const Vec3f& v : mesh.vertices) {
    const double d = (v.cast<double>() - wanted).squaredNorm();
    if (d >= least) continue;
    least = d;
    middle = v.cast<double>();
  }
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    if ((mesh.vertices[i].cast<double>() - middle).norm() < fault.spot_mm) mesh.albedo[i] = kSoot;
}

Web::Web(const FaultConfig& fault, const Dentition& dentition) : thickness_mm_(kFaultMmPerUm * fault.web_um) {
  const std::size_t at = tooth_at(fault, dentition);
  if (at + 1 >= dentition.teeth.size()) {
    thickness_mm_ = 0;
    return;
  }
  constexpr double kInto = 0.25;  // of a tooth's width: how far the web reaches into it
  constexpr double kHigh = 0.7;   // of the crown's height
  const PlacedTooth &a = dentition.teeth[at], &b = dentition.teeth[at + 1];
  s_ = 0.5 * (a.s + 0.5 * a.form.mesiodistal + b.s - 0.5 * b.form.mesiodistal);
  half_ = 0.5 * fault.gap_mm + kInto * std::min(a.form.mesiodistal, b.form.mesiodistal);
  top_ = kHigh * std::min(a.form.height, b.form.height);
}

double Web::value(double s, double n, double z) const {
  if (!(thickness_mm_ > 0)) return std::numeric_limits<double>::max();
  return std::max({std::abs(n) - 0.5 * thickness_mm_, std::abs(s - s_) - half_, z - top_});
}

}  // namespace enamel::twin
