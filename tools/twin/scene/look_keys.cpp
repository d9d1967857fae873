#include "tools/twin/scene/look_keys.hpp"

#include <cmath>
#include <string>

namespace enamel::twin {
namespace {

enum class BodyMaterial : int {};  // a MaterialId's number, or LookConfig::kMouth

constexpr std::array<std::pair<std::string_view, BodyMaterial>, kMaterials + 1> look_names() {
  std::array<std::pair<std::string_view, BodyMaterial>, kMaterials + 1> out{};
  for (std::size_t i = 0; i < kMaterials; ++i) out[i] = {kMaterialNames[i], static_cast<BodyMaterial>(i)};
  out[kMaterials] = {"mouth", static_cast<BodyMaterial>(kMaterials)};
  return out;
}

/// Lobes as three lists of equal length; a list that is not given stays as it is.
void bind_lobes(ConfigReader& r, Material& m) {
  std::vector<double> weights, sigmas, depths;
  for (const Lobe& l : m.lobes) {
    weights.push_back(l.weight);
    sigmas.push_back(l.sigma_mm);
    depths.push_back(l.depth_mm);
  }
  double sigma_scale = 1, depth_scale = 1;
  r.bind("lobe_weights", weights, {0, 1000}, "shares of the light inside, relative to each other");
  r.bind("lobe_sigmas_mm", sigmas, {0, 5}, "spread of each along the surface");
  r.bind("lobe_depths_mm", depths, {0, 5}, "depth below the surface that each comes from, seen from straight above");
  r.bind("sigma_scale", sigma_scale, {0, 4}, "times all spreads");
  r.bind("depth_scale", depth_scale, {0, 4}, "times all depths");
  if (weights.size() != sigmas.size() || weights.size() != depths.size() || weights.size() > kMaxLobes) {
    r.reject("lobe_weights", "weights, spreads and depths are not as many, or more than four");
    return;
  }
  m.lobes.clear();
  for (std::size_t i = 0; i < weights.size(); ++i) {
    m.lobes.push_back({weights[i], sigma_scale * sigmas[i], depth_scale * depths[i]});
  }
}

void bind_material(ConfigReader r, Material& m) {
  r.bind("albedo", m.albedo, {0, 1}, "diffuse reflectance");
  r.bind("surface_share", m.surface_share, {0, 1}, "of the diffuse light, scattered at the surface itself");
  r.bind("index", m.index, {1.05, 4}, "of refraction");
  r.bind("specular", m.specular, {0, 5}, "mirror light: times that of the index; of metals the reflectance, at most 1");
  r.bind("roughness", m.roughness, {0.01, 1}, "GGX alpha");
  bind_lobes(r, m);
}

void bind_teeth(ConfigReader& r, std::string_view key, std::vector<double>& teeth, std::string_view doc) {
  constexpr double kLastTooth = 7;
  r.bind(key, teeth, {-kLastTooth, kLastTooth}, doc);
  for (const double each : teeth) {
    if (each == 0 || each != std::round(each)) r.reject(key, "teeth are whole numbers, 1 ... 7, negative on the left");
  }
}

void bind_mouth(ConfigReader r, MouthConfig& m) {
  bind_teeth(r, "metal_crowns", m.metal_crowns, "teeth under a metal crown");
  bind_teeth(r, "ceramic", m.ceramic, "teeth under a glazed crown");
  bind_teeth(r, "amalgam", m.amalgam, "teeth with a filling in the biting surface");
  bind_teeth(r, "stained", m.stained, "brown teeth");
  bind_teeth(r, "dark", m.dark, "grey teeth without live pulp");
  bind_teeth(r, "dentine", m.dentine, "teeth with bare necks");
  r.bind("blood_mm", m.blood_mm, {-70, 70}, "arc length of spots of blood at the outer gum margin");
}

void bind_film(ConfigReader r, FilmConfig& f) {
  r.bind("wet_share", f.wet_share, {0, 1}, "part of the surface under a film of saliva, in patches");
  r.bind("thickness_um", f.thickness_um, {1, 1000}, "of the film");
  r.bind("pools", f.pools_mm, {0, 3}, "mm above their bottom that fissures and pits are filled; 0: no pools");
  r.bind("bubbles", f.bubbles, {0, 1000}, "bubbles on the film, all over the body");
  r.bind("roughness", f.roughness, {0.01, 1}, "GGX alpha of the film's upper side");
}

}  // namespace

void bind_look(ConfigReader& reader, SceneConfig& config) {
  static constexpr auto kLooks = look_names();
  LookConfig& look = config.look;
  auto chosen = static_cast<BodyMaterial>(look.material);
  reader.bind("object.material", chosen, kLooks, "plaster, mouth, or one material for the whole body");
  look.material = static_cast<int>(chosen);
  bind_mouth(reader.table("mouth"), look.mouth);
  bind_film(reader.table("film"), look.film);
  for (std::size_t i = 1; i < kMaterials; ++i) {
    bind_material(reader.table("materials." + std::string(kMaterialNames[i])), look.materials[i]);
  }
  const MouthConfig& m = look.mouth;
  const bool is_dressed = !(m.metal_crowns.empty() && m.ceramic.empty() && m.amalgam.empty() && m.stained.empty() &&
                            m.dark.empty() && m.dentine.empty() && m.blood_mm.empty());
  const bool goes_with = look.material == LookConfig::kMouth || look.material == LookConfig::kPlaster;
  if (is_dressed && !(goes_with && config.object == ObjectKind::kJaw)) {
    reader.reject("mouth", "goes with object.type = jaw and object.material = mouth; plaster leaves it out");
  }
}

}  // namespace enamel::twin
