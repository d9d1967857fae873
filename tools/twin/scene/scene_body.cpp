#include <nlohmann/json.hpp>
#include <utility>

#include "protocol/base/json_text.hpp"
#include "tools/twin/jaw/bite.hpp"
#include "tools/twin/scene/looks.hpp"
#include "tools/twin/scene/scene.hpp"
#include "tools/twin/surface/mesh_file.hpp"

namespace enamel::twin {
namespace {

using SortedJson = nlohmann::json;

SortedJson describe(const Ball& b) {
  return {{"type", "sphere"}, {"centre", {b.centre.x(), b.centre.y(), b.centre.z()}}, {"radius", b.radius}};
}

Body make_jaw_body(const SceneConfig& config, SortedJson& objects) {
  Body body;
  Jaw jaw = make_jaw(jaw_of_look(config), config.seed);
  body.arch = jaw.dentition.shape;
  SortedJson teeth = SortedJson::array();
  for (const auto& t : jaw.dentition.teeth) {
    teeth.push_back({{"arc_mm", t.s},
                     {"mesiodistal_mm", t.form.mesiodistal},
                     {"buccolingual_mm", t.form.buccolingual},
                     {"height_mm", t.form.height},
                     {"origin", {t.origin.x(), t.origin.y(), t.origin.z()}}});
  }
  objects.push_back({{"type", "mesh"},
                     {"file", "surface.ply"},
                     {"jaw", config.jaw.side == JawSide::kLower ? "lower" : "upper"},
                     {"arch", {body.arch.half_width_mm, body.arch.depth_mm, body.arch.exponent}},
                     {"teeth", teeth}});
  body.surroundings.mesh = std::move(jaw.mesh);
  body.dentition = std::move(jaw.dentition);
  return body;
}

SortedJson rows_of(const Eigen::Isometry3d& T) {
  SortedJson rows = SortedJson::array();
  for (int r = 0; r < 4; ++r) rows.push_back({T.matrix()(r, 0), T.matrix()(r, 1), T.matrix()(r, 2), T.matrix()(r, 3)});
  return rows;
}

Body make_bite_body(const SceneConfig& config, SortedJson& objects) {
  Body body;
  Bite bite = make_bite(jaw_of_look(config), config.seed);
  objects.push_back({{"type", "mesh"},
                     {"file", "surface.ply"},
                     {"T_bite_lower", rows_of(bite.T_bite_lower)},
                     {"T_bite_upper", rows_of(bite.T_bite_upper)}});
  body.surroundings.mesh = std::move(bite.mesh);
  return body;
}

Body make_ridge_body(const SceneConfig& config, SortedJson& objects) {
  Body body;
  Ridge ridge = make_ridge(config.ridge, config.seed);
  body.arch = ridge.shape;
  objects.push_back({{"type", "mesh"},
                     {"file", "surface.ply"},
                     {"arch", {body.arch.half_width_mm, body.arch.depth_mm, body.arch.exponent}},
                     {"relief_um", config.ridge.relief_um}});
  body.surroundings.mesh = std::move(ridge.mesh);
  return body;
}

void finish_surface(const SceneConfig& config, Body& body) {
  apply_look(config, body);
  if (config.effects.texture && config.object != ObjectKind::kBoard) {
    apply_texture(body.surroundings.mesh, config.texture, config.seed);
  }
}

/// The same jaw after a tooth of it has moved.
void add_later(const SceneConfig& config, Body& body) {
  if (config.object != ObjectKind::kJaw || !(config.jaw.fault.move_um > 0)) return;
  Jaw jaw = make_jaw(jaw_of_look(config), config.seed, /*moved=*/true);
  Body moved;
  moved.arch = body.arch;
  moved.surroundings.mesh = std::move(jaw.mesh);
  moved.dentition = std::move(jaw.dentition);
  finish_surface(config, moved);
  body.later = std::move(moved.surroundings);
}

/// The tooth that something is wrong with: its frame in the model.
void describe_fault(const SceneConfig& config, const Body& body, SortedJson& objects) {
  int number = 0;
  for (const PlacedTooth& t : body.dentition.teeth) {
    if (t.s <= 0 || ++number != config.jaw.fault.tooth) continue;
    Eigen::Isometry3d T_model_tooth = Eigen::Isometry3d::Identity();
    T_model_tooth.linear() = t.R;
    T_model_tooth.translation() = t.origin;
    objects.front()["fault_tooth"] = {{"number", number}, {"T_model_tooth", rows_of(T_model_tooth)}};
  }
}

/// The known artefact beside teeth or ridge.
void add_bar(const SceneConfig& config, Body& body, SortedJson& objects) {
  if (config.bar.arc_mm.empty()) return;
  SphereBar bar = make_sphere_bar(config.bar, body.arch, config.seed);
  for (const Ball& ball : bar.balls) objects.push_back(describe(ball));
  append(body.surroundings.mesh, bar.rods);
  body.surroundings.balls = std::move(bar.balls);
  body.certificate_json = std::move(bar.certificate_json);
}

}  // namespace

ProjectorConfig effective_projector(const SceneConfig& c) {
  ProjectorConfig p = c.projector;
  p.round_levels = c.effects.round_levels;
  if (!c.effects.gamma) p.gamma = p.lut_gamma = 1.0;
  if (!c.effects.defocus) p.defocus_px_per_mm = 0;
  p.spread_mm = widest_spread_mm(effective_materials(c));
  return p;
}

std::vector<MoverConfig> effective_movers(const SceneConfig& c) {
  if (!c.effects.movers) return {};
  std::vector<MoverConfig> out = c.movers;
  for (MoverConfig& m : out) m.mucosa = c.look.material != LookConfig::kPlaster;
  return out;
}

RenderConfig effective_render(const SceneConfig& c) {
  RenderConfig r = c.render;
  r.light.falloff = c.effects.falloff;
  r.light.shadow = c.effects.shadow;
  if (!c.effects.ambient) r.light.ambient = 0;
  if (!c.effects.lamp) r.light.lamp.strength = 0;
  return r;
}

SensorConfig effective_sensor(const SceneConfig& c, const calib::NoiseValues& noise) {
  SensorConfig s;
  s.psf_sigma_px = c.effects.camera_psf ? c.psf_sigma_px : 0;
  s.full_well_e = noise.full_well_e;
  s.read_noise_e = noise.read_noise_e;
  s.gain_e_per_dn = noise.gain_e_per_dn;
  s.black_dn = noise.black_dn;
  s.bits = noise.bits;
  s.shot_noise = c.effects.shot_noise;
  s.read_noise = c.effects.read_noise;
  return s;
}

Result<Body> make_body(const SceneConfig& config) {
  Body body;
  SortedJson objects = SortedJson::array();
  switch (config.object) {
    case ObjectKind::kJaw:
      body = make_jaw_body(config, objects);
      break;
    case ObjectKind::kBite:
      body = make_bite_body(config, objects);
      break;
    case ObjectKind::kRidge:
      body = make_ridge_body(config, objects);
      break;
    case ObjectKind::kPlane:
      body.surroundings = make_plane(config.plane);
      objects.push_back({{"type", "plane"}, {"half", {config.plane.half_mm, config.plane.half_mm}}});
      break;
    case ObjectKind::kSpheres:
      body.surroundings = make_spheres(config.spheres);
      for (const auto& b : body.surroundings.balls) objects.push_back(describe(b));
      objects.push_back({{"type", "mesh"}, {"file", "surface.ply"}});
      break;
    case ObjectKind::kSteps:
      body.surroundings = make_steps(config.steps);
      objects.push_back({{"type", "mesh"}, {"file", "surface.ply"}});
      break;
    case ObjectKind::kPlate: {
      RingPlate plate = make_ring_plate(config.plate, config.seed);
      for (const auto& b : plate.surroundings.balls) objects.push_back(describe(b));
      objects.push_back({{"type", "mesh"}, {"file", "surface.ply"}});
      body.surroundings = std::move(plate.surroundings);
      body.certificate_json = std::move(plate.certificate_json);
      break;
    }
    case ObjectKind::kBoard:
      body.surroundings = make_dot_board(config.board, config.seed);
      objects.push_back(SortedJson::parse(target_json(config.board)));
      break;
    case ObjectKind::kFile: {
      ENAMEL_TRY_ASSIGN(body.surroundings.mesh, load_mesh(config.file.path, static_cast<float>(config.file.albedo)));
      if (config.file.max_edge_mm > 0) refine_edges(body.surroundings.mesh, config.file.max_edge_mm);
      objects.push_back({{"type", "mesh"}, {"file", "surface.ply"}});
      break;
    }
  }
  finish_surface(config, body);
  add_later(config, body);
  add_bar(config, body, objects);
  describe_fault(config, body, objects);
  SortedJson scene{{"frame", "model"}, {"units", "mm"}, {"seed", config.seed}, {"objects", objects}};
  describe_look(config, body, scene);
  body.description_json = json_text(scene, 1) + "\n";
  return body;
}

Result<calib::Rig> apply_effects(const calib::Rig& rig, const Effects& effects) {
  if (effects.lens_distortion && effects.adc) return rig;
  if (!effects.adc && !rig.noise) return fail(ErrorCode::kRigInvalid, "effects.adc = false needs noise in the rig");
  SortedJson json = SortedJson::parse(rig.text, nullptr, false);
  if (!json.is_object()) return fail(ErrorCode::kRigInvalid, "rig text is not JSON");
  if (!effects.lens_distortion) {
    for (const char* lens : {"camera", "projector"}) json[lens]["dist"] = SortedJson::array({0, 0, 0, 0, 0});
  }
  if (!effects.adc) {
    constexpr double kFiner = 256;
    json["noise"]["bits"] = 16;
    json["noise"]["gain_e_per_dn"] = rig.noise->gain_e_per_dn / kFiner;
    json["noise"]["black_dn"] = rig.noise->black_dn * kFiner;
  }
  return calib::parse_rig(json_text(json, 1) + "\n");
}

}  // namespace enamel::twin
