#include "tools/twin/jaw/jaw.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "tools/twin/jaw/strip.hpp"

namespace enamel::twin {
namespace {

constexpr double kInsideMm = 9.5, kOutsideMm = 8.0;  // width of the strip about the arch
constexpr double kPalateMm = 40;                     // beyond the middle of any arch
constexpr double kLowZ = -13, kHighZ = 13;

Strip strip_of(const JawConfig& config, const Dentition& d, const Arch& arch) {
  constexpr double kBeyond = 3.5;
  Strip strip{config.from_mm, config.to_mm, config.palate ? kPalateMm : kInsideMm, kOutsideMm, kLowZ, kHighZ};
  if (config.to_mm <= config.from_mm) {
    strip.from = d.teeth.front().s - 0.5 * d.teeth.front().form.mesiodistal - kBeyond;
    strip.to = d.teeth.back().s + 0.5 * d.teeth.back().form.mesiodistal + kBeyond;
  }
  // Behind the arch its two sides meet in no seam.
  if (config.palate) strip.back = std::min(arch.point(strip.from).y(), arch.point(strip.to).y());
  return strip;
}

}  // namespace

Jaw make_jaw(const JawConfig& config, std::uint64_t seed, bool moved) {
  Jaw jaw;
  jaw.dentition = make_dentition(config.side, config.last_tooth, config.both_sides, seed,
                                 {config.fault.tooth, config.fault.gap_mm});
  apply_fault(config.fault, jaw.dentition);
  if (moved) move_tooth(config.fault, jaw.dentition);
  const JawField solid(jaw.dentition, config.side, seed,
                       config.palate ? JawField::Inside::kVault : JawField::Inside::kRim);
  const Web web(config.fault, jaw.dentition);
  const Arch arch(jaw.dentition.shape);
  jaw.mesh = mesh_strip(strip_of(config, jaw.dentition, arch), arch, solid.coordinates(),
                        {config.max_edge_mm, JawField::kLipschitz}, [&](const Eigen::Vector3d& p) {
                          const ArchCoordinates::At a = solid.coordinates().at(p.x(), p.y());
                          return std::min(solid.value(p), web.value(a.s, a.n, p.z()));
                        });
  jaw.mesh.material.resize(jaw.mesh.vertices.size());
  tbb::parallel_for(std::size_t{0}, jaw.mesh.vertices.size(), [&](std::size_t i) {
    const auto sample = solid.sample(jaw.mesh.vertices[i].cast<double>());
    constexpr double kStain = 0.22;
    const double tooth = config.enamel_albedo * (1.0 - kStain * sample.groove);
    jaw.mesh.albedo[i] = static_cast<float>(sample.enamel * tooth + (1.0 - sample.enamel) * config.gum_albedo);
    constexpr double kMostlyTooth = 0.5;
    const MaterialId id = sample.enamel >= kMostlyTooth ? MaterialId::kEnamel : MaterialId::kGum;
    jaw.mesh.material[i] = static_cast<std::uint8_t>(id);
  });
  blacken_spot(config.fault, jaw.dentition, seed, jaw.mesh);
  refine_edges(jaw.mesh, config.max_edge_mm);
  return jaw;
}

}  // namespace enamel::twin
