#include "tools/twin/scene/looks.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

namespace enamel::twin {
namespace {

bool is_plaster(const SceneConfig& c) { return c.look.material == LookConfig::kPlaster; }

/// What stands for "mouth" where there are no teeth beside gum.
std::uint8_t whole_material(const SceneConfig& c) {
  if (c.look.material != LookConfig::kMouth) return static_cast<std::uint8_t>(c.look.material);
  return static_cast<std::uint8_t>(c.object == ObjectKind::kRidge ? MaterialId::kGum : MaterialId::kEnamel);
}

/// Every second strip of the plane stays plaster.
void lay_strips(double strip_mm, TriSurface& mesh) {
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const auto strip = static_cast<long>(std::floor(static_cast<double>(mesh.vertices[i].y()) / strip_mm + 0.5));
    if (strip % 2 == 0) continue;
    mesh.material[i] = static_cast<std::uint8_t>(MaterialId::kPlaster);
    mesh.albedo[i] = static_cast<float>(Material{}.albedo);
  }
}

void paint(const SceneConfig& config, Body& body) {
  TriSurface& mesh = body.surroundings.mesh;
  if (config.object == ObjectKind::kJaw && config.look.material == LookConfig::kMouth) {
    dress_mouth(mesh, body.dentition, config.look.mouth, config.look.materials, config.seed);
    return;
  }
  const std::uint8_t id = whole_material(config);
  const auto albedo = static_cast<float>(config.look.materials[id].albedo);
  mesh.material.assign(mesh.vertices.size(), id);
  mesh.albedo.assign(mesh.vertices.size(), albedo);
  if (config.object == ObjectKind::kPlane && config.plane.strip_mm > 0) lay_strips(config.plane.strip_mm, mesh);
  for (Ball& ball : body.surroundings.balls) {
    ball.material = id;
    ball.albedo = albedo;
  }
}

nlohmann::json describe(const Material& m) {
  nlohmann::json lobes = nlohmann::json::array();
  for (const Lobe& l : m.lobes) lobes.push_back({l.weight, l.sigma_mm, l.depth_mm});
  return {{"albedo", m.albedo},      {"surface_share", m.lobes.empty() ? 1.0 : m.surface_share},
          {"lobes", lobes},          {"index", m.index},
          {"metal", m.is_metal},     {"specular", m.specular},
          {"roughness", m.roughness}};
}

}  // namespace

MaterialTable effective_materials(const SceneConfig& config) {
  MaterialTable out{};
  if (!is_plaster(config)) {
    out = config.look.materials;
  } else if (config.effects.film && !config.look.film.is_dry()) {
    out[index_of(MaterialId::kFoam)] = config.look.materials[index_of(MaterialId::kFoam)];
  }
  for (Material& m : out) {
    if (!config.effects.translucency) m.lobes.clear();
    if (!config.effects.gloss) m.specular = 0;
  }
  return out;
}

JawConfig jaw_of_look(const SceneConfig& config) {
  JawConfig out = config.jaw;
  if (is_plaster(config)) return out;
  out.enamel_albedo = config.look.materials[index_of(MaterialId::kEnamel)].albedo;
  out.gum_albedo = config.look.materials[index_of(MaterialId::kGum)].albedo;
  return out;
}

void apply_look(const SceneConfig& config, Body& body) {
  TriSurface& mesh = body.surroundings.mesh;
  if (config.object == ObjectKind::kBoard) return;
  body.surroundings.materials = effective_materials(config);
  body.surroundings.film_roughness = config.look.film.roughness;
  if (is_plaster(config)) {
    mesh.material.clear();
  } else {
    paint(config, body);
  }
  if (config.effects.film) add_film(mesh, config.look.film, config.look.materials, config.seed);
}

void describe_look(const SceneConfig& config, const Body& body, nlohmann::json& scene) {
  if (is_plaster(config) || config.object == ObjectKind::kBoard) return;
  nlohmann::json table = nlohmann::json::object();
  for (std::size_t i = 0; i < kMaterials; ++i) {
    nlohmann::json entry = describe(body.surroundings.materials[i]);
    entry["number"] = i;
    table[std::string(kMaterialNames[i])] = std::move(entry);
  }
  scene["materials"] = std::move(table);
  const FilmConfig& film = config.look.film;
  if (config.effects.film && !film.is_dry()) {
    scene["film"] = {{"wet_share", film.wet_share},
                     {"thickness_um", film.thickness_um},
                     {"pools_mm", film.pools_mm},
                     {"bubbles", film.bubbles},
                     {"roughness", film.roughness}};
  }
  if (config.object != ObjectKind::kJaw || config.look.material != LookConfig::kMouth) return;
  const MouthConfig& m = config.look.mouth;
  scene["mouth"] = {{"tooth_numbers", tooth_numbers(body.dentition)},
                    {"metal_crowns", m.metal_crowns},
                    {"ceramic", m.ceramic},
                    {"amalgam", m.amalgam},
                    {"stained", m.stained},
                    {"dark", m.dark},
                    {"dentine", m.dentine},
                    {"blood_mm", m.blood_mm}};
}

}  // namespace enamel::twin
