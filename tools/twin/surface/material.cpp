#include "tools/twin/surface/material.hpp"

#include <algorithm>
#include <utility>

namespace enamel::twin {
namespace {

// Lobes are fits to transfer functions and apparent depths of semi-infinite media, between the octaves too: k = M d /
// (1 - M) of photons grows as the period to the power of 1.75 from 0.5 to 6 mm (tests/unit/twin/slant_photons.hpp), so
// that no period and no slant stands out. Depths are the apparent ones times the index.

/// Enamel: scattering 15 … 17 / mm, g = 0.68, absorption 0.06 / mm, n = 1.63 (Fried 1995 at 543 … 1053 nm, carried on
/// to 455 nm; guessed to a factor of two). At 0.5, 1, 2, 4 mm the table of the design, photons' shape between.
const std::vector<Lobe> kEnamelLobes{
    {0.076, 0.036, 0.112}, {0.172, 0.202, 0.226}, {0.391, 0.481, 0.265}, {0.361, 1.012, 0.307}};
/// Dentine: scattering 28 / mm, g = 0.93 (Fried 1995), absorption 0.35 / mm, n = 1.54.
const std::vector<Lobe> kDentineLobes{
    {0.102, 0.048, 0.142}, {0.211, 0.250, 0.390}, {0.354, 0.553, 0.512}, {0.334, 1.050, 0.418}};
/// Mucosa: scattering 20 / mm, g = 0.9, absorption 0.7 / mm by blood at 455 nm, n = 1.38.
const std::vector<Lobe> kGumLobes{
    {0.148, 0.034, 0.140}, {0.295, 0.218, 0.318}, {0.435, 0.512, 0.458}, {0.122, 0.980, 0.495}};

/// What absorbs more lets light travel less far.
std::vector<Lobe> narrowed(std::vector<Lobe> lobes, double scale) {
  for (Lobe& l : lobes) {
    l.sigma_mm *= scale;
    l.depth_mm *= scale;
  }
  return lobes;
}

Material dielectric(double albedo, double surface_share, std::vector<Lobe> lobes, double index, double roughness) {
  Material m;
  m.albedo = albedo;
  m.surface_share = surface_share;
  m.lobes = std::move(lobes);
  m.index = index;
  m.specular = 1;
  m.roughness = roughness;
  return m;
}

Material metal(double albedo, double reflectance, double roughness) {
  Material m;
  m.albedo = albedo;
  m.specular = reflectance;
  m.roughness = roughness;
  m.is_metal = true;
  return m;
}

}  // namespace

MaterialTable default_materials() {
  MaterialTable t{};
  const auto set = [&](MaterialId id, Material m) { t[index_of(id)] = std::move(m); };
  // Reflectances at 455 nm relative to plaster, by judgement from shade guides and mucosa spectra.
  set(MaterialId::kEnamel, dielectric(0.60, 0.15, kEnamelLobes, 1.63, 0.25));
  set(MaterialId::kDentine, dielectric(0.42, 0.15, kDentineLobes, 1.54, 0.40));
  set(MaterialId::kStained, dielectric(0.30, 0.20, narrowed(kEnamelLobes, 0.7), 1.63, 0.30));
  set(MaterialId::kDark, dielectric(0.16, 0.25, narrowed(kEnamelLobes, 0.5), 1.63, 0.25));
  set(MaterialId::kGum, dielectric(0.22, 0.20, kGumLobes, 1.38, 0.25));
  // Cobalt-chromium and amalgam in blue light; brushed, not polished.
  set(MaterialId::kMetal, metal(0.05, 0.60, 0.28));
  set(MaterialId::kAmalgam, metal(0.10, 0.45, 0.35));
  set(MaterialId::kCeramic, dielectric(0.62, 0.25, narrowed(kEnamelLobes, 0.8), 1.52, 0.08));
  set(MaterialId::kBlood, dielectric(0.04, 1.0, {}, 1.36, 0.08));
  set(MaterialId::kFoam, dielectric(0.70, 1.0, {}, 1.33, 0.10));
  return t;
}

double widest_spread_mm(const MaterialTable& materials) {
  double widest = 0;
  for (const Material& m : materials) {
    for (const Lobe& l : m.lobes) widest = std::max(widest, l.sigma_mm);
  }
  return widest;
}

}  // namespace enamel::twin
