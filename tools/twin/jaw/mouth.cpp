#include "tools/twin/jaw/mouth.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/twin/surface/noise.hpp"

namespace enamel::twin {
namespace {

/// Which material a tooth's places are.
class Dresser {
 public:
  Dresser(const Dentition& dentition, const MouthConfig& config, std::uint64_t seed)
      : dentition_(dentition), seed_(seed), crown_(dentition.teeth.size(), MaterialId::kEnamel) {
    const std::vector<int> numbers = tooth_numbers(dentition);
    const auto has = [](const std::vector<double>& list, int number) {
      return std::any_of(list.begin(), list.end(), [&](double each) { return std::lround(each) == number; });
    };
    for (std::size_t i = 0; i < crown_.size(); ++i) {
      if (has(config.stained, numbers[i])) crown_[i] = MaterialId::kStained;
      if (has(config.dark, numbers[i])) crown_[i] = MaterialId::kDark;
      if (has(config.ceramic, numbers[i])) crown_[i] = MaterialId::kCeramic;
      if (has(config.metal_crowns, numbers[i])) crown_[i] = MaterialId::kMetal;
      filled_.push_back(has(config.amalgam, numbers[i]));
      bare_.push_back(has(config.dentine, numbers[i]));
    }
  }

  /// Of a place on the crowns.
  [[nodiscard]] MaterialId at(const Vec3d& p) const {
    std::size_t best = 0;
    Vec3d q = Vec3d::Zero();
    double least = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < crown_.size(); ++i) {
      const PlacedTooth& t = dentition_.teeth[i];
      const Vec3d local = t.R.transpose() * (p - t.origin);
      const double out = std::max(std::abs(local.x()) / t.form.mesiodistal, std::abs(local.y()) / t.form.buccolingual);
      if (out >= least) continue;
      least = out;
      best = i;
      q = local;
    }
    const ToothForm& form = dentition_.teeth[best].form;
    const double ragged = value_noise(p / kRaggedMm, seed_ ^ 0x66696CULL);
    if (filled_[best]) {
      const double radius = kFillingRadius + kFillingRagged * ragged;
      const double out = std::hypot(q.x() / (kFillingLength * form.mesiodistal), q.y() / form.buccolingual);
      if (out < radius && q.z() > kFillingFloor * form.height) return MaterialId::kAmalgam;
    }
    if (bare_[best] && q.z() < kBareMm + kBareRaggedMm * ragged) return MaterialId::kDentine;
    return crown_[best];
  }

 private:
  static constexpr double kRaggedMm = 0.8;                               // size of the unevenness of borders
  static constexpr double kFillingRadius = 0.22, kFillingRagged = 0.04;  // of the tooth's width
  static constexpr double kFillingLength = 1.4;                          // longer along the arch than across
  static constexpr double kFillingFloor = 0.35;                          // of the crown's height
  static constexpr double kBareMm = 2.2, kBareRaggedMm = 0.4;
  const Dentition& dentition_;
  std::uint64_t seed_;
  std::vector<MaterialId> crown_;
  std::vector<bool> filled_, bare_;
};

/// Vertices of facets that belong to both gum and tooth.
std::vector<std::uint32_t> margin_of(const TriSurface& mesh) {
  constexpr auto kGum = static_cast<std::uint8_t>(MaterialId::kGum);
  std::vector<std::uint32_t> out;
  for (const auto& t : mesh.triangles) {
    const auto gums = std::count_if(t.begin(), t.end(), [&](std::uint32_t i) { return mesh.material[i] == kGum; });
    if (gums > 0 && gums < 3) out.insert(out.end(), t.begin(), t.end());
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// A spot about the outer gum margin nearest to an arc length.
void bleed(TriSurface& mesh, const std::vector<std::uint32_t>& margin, const Vec3d& beside, std::uint64_t seed) {
  constexpr double kRadiusMm = 0.9, kRagged = 0.5, kRaggedMm = 0.7;
  if (margin.empty()) return;
  const auto distance = [&](std::uint32_t i) { return (mesh.vertices[i].cast<double>() - beside).head<2>().norm(); };
  const std::uint32_t nearest = *std::min_element(
      margin.begin(), margin.end(), [&](std::uint32_t a, std::uint32_t b) { return distance(a) < distance(b); });
  const Vec3d centre = mesh.vertices[nearest].cast<double>();
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vec3d p = mesh.vertices[i].cast<double>();
    const double away = (p - centre).norm();
    if (away > kRadiusMm * (1.0 + kRagged)) continue;
    if (away > kRadiusMm * (1.0 + kRagged * value_noise(p / kRaggedMm, seed ^ 0x626CULL))) continue;
    mesh.material[i] = static_cast<std::uint8_t>(MaterialId::kBlood);
  }
}

}  // namespace

std::vector<int> tooth_numbers(const Dentition& dentition) {
  std::vector<int> out(dentition.teeth.size());
  int left = 0, right = 0;
  for (const PlacedTooth& t : dentition.teeth) left += t.s < 0 ? 1 : 0;
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = dentition.teeth[i].s < 0 ? -left-- : ++right;
  return out;
}

void dress_mouth(TriSurface& mesh, const Dentition& dentition, const MouthConfig& config,
                 const MaterialTable& materials, std::uint64_t seed) {
  const std::vector<std::uint32_t> margin = margin_of(mesh);
  const Dresser dresser(dentition, config, seed);
  tbb::parallel_for(std::size_t{0}, mesh.vertices.size(), [&](std::size_t i) {
    if (mesh.material[i] != static_cast<std::uint8_t>(MaterialId::kEnamel)) return;
    mesh.material[i] = static_cast<std::uint8_t>(dresser.at(mesh.vertices[i].cast<double>()));
  });
  constexpr double kMarginOutMm = 6.0;  // outside of any crown
  const Arch arch(dentition.shape);
  for (const double s : config.blood_mm) {
    const Eigen::Vector2d beside = arch.point(s) + kMarginOutMm * arch.buccal(s);
    bleed(mesh, margin, Vec3d(beside.x(), beside.y(), 0), seed);
  }
  const double enamel = std::max(1e-6, materials[index_of(MaterialId::kEnamel)].albedo);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const auto id = static_cast<MaterialId>(mesh.material[i]);
    if (id == MaterialId::kEnamel || id == MaterialId::kGum) continue;
    const double albedo = materials[mesh.material[i]].albedo;
    const bool is_tooth = id == MaterialId::kStained || id == MaterialId::kDark || id == MaterialId::kDentine;
    // A tooth keeps its dark fissures.
    const double share = is_tooth ? static_cast<double>(mesh.albedo[i]) / enamel : 1.0;
    mesh.albedo[i] = static_cast<float>(albedo * share);
  }
}

}  // namespace enamel::twin
