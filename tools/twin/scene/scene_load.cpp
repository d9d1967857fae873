#include <array>
#include <filesystem>
#include <utility>

#include "tools/twin/board/target_file.hpp"
#include "tools/twin/scene/fault_keys.hpp"
#include "tools/twin/scene/look_keys.hpp"
#include "tools/twin/scene/mount_keys.hpp"
#include "tools/twin/scene/passing_keys.hpp"
#include "tools/twin/scene/path_keys.hpp"
#include "tools/twin/scene/scene.hpp"

namespace enamel::twin {
namespace {

using Names = std::string_view;
constexpr std::array<std::pair<Names, ObjectKind>, 9> kObjects{{{"jaw", ObjectKind::kJaw},
                                                                {"bite", ObjectKind::kBite},
                                                                {"ridge", ObjectKind::kRidge},
                                                                {"plane", ObjectKind::kPlane},
                                                                {"spheres", ObjectKind::kSpheres},
                                                                {"steps", ObjectKind::kSteps},
                                                                {"plate", ObjectKind::kPlate},
                                                                {"file", ObjectKind::kFile},
                                                                {"board", ObjectKind::kBoard}}};
constexpr std::array<std::pair<Names, TexturePattern>, 2> kPatterns{
    {{"mottle", TexturePattern::kMottle}, {"vessels", TexturePattern::kVessels}}};
constexpr std::array<std::pair<Names, JawSide>, 2> kSides{{{"lower", JawSide::kLower}, {"upper", JawSide::kUpper}}};

void bind_effects(ConfigReader r, Effects& e) {
  r.bind("round_levels", e.round_levels, "projector levels are 8-bit integers");
  r.bind("gamma", e.gamma, "projector look-up table and response");
  r.bind("defocus", e.defocus, "projector blur grows away from its focus");
  r.bind("lens_distortion", e.lens_distortion, "distortion of both lenses; off: the rig has none");
  r.bind("falloff", e.falloff, "cos^4 of both lenses and 1/r^2");
  r.bind("ambient", e.ambient, "light that does not come from the projector");
  r.bind("shadow", e.shadow, "surfaces cast shadows");
  r.bind("texture", e.texture, "smooth mottling of the albedo");
  r.bind("camera_psf", e.camera_psf, "point spread of the camera lens");
  r.bind("motion", e.motion, "the probe moves during and between the four frames");
  r.bind("exposure", e.exposure, "motion during one exposure");
  r.bind("tremor", e.tremor, "shake and wander of the hand");
  r.bind("shot_noise", e.shot_noise, "photon noise");
  r.bind("read_noise", e.read_noise, "noise of the read-out");
  r.bind("adc", e.adc, "rounding to the rig's bits; off: 16-bit samples, 256 to one step");
  r.bind("translucency", e.translucency, "light inside the materials; off: all of it returns from the surface");
  r.bind("gloss", e.gloss, "mirror light of the materials");
  r.bind("film", e.film, "saliva; off: dry");
  r.bind("movers", e.movers, "bodies that move by themselves");
  r.bind("fog", e.fog, "breath on the window");
  r.bind("lamp", e.lamp, "the lamp over the chair");
}

void bind_timing(ConfigReader r, TimingConfig& t) {
  r.bind("burst_rate_hz", t.burst_rate_hz, {0.1, 200}, "bursts a second");
  r.bind("frame_period_ms", t.frame_period_ms, {0.1, 1000}, "start of one exposure to the next");
  r.bind("exposure_ms", t.exposure_ms, {0.01, 1000}, "length of an exposure");
  r.bind("exposure_ratio", t.exposure_ratio, {1, 16}, "every second burst is exposed so many times shorter");
  r.bind("start_s", t.start_s, {0, 1e6}, "device clock at the first exposure");
  r.bind("bursts", t.bursts, {0, 1000000}, "0: as many as the path takes");
}

void bind_projector(ConfigReader r, ProjectorConfig& p) {
  r.bind("gamma", p.gamma, {0.3, 5}, "emission is level^gamma");
  r.bind("lut_gamma", p.lut_gamma, {0.3, 5}, "exponent that the inverse look-up table assumes");
  r.bind("black_fraction", p.black_fraction, {0, 0.5}, "emission of level 0 relative to level 255");
  r.bind("blur_sigma_px", p.blur_sigma_px, {0, 20}, "Gaussian blur at best focus, projector px");
  r.bind("defocus_px_per_mm", p.defocus_px_per_mm, {0, 5}, "blur added in quadrature per mm from the focus");
  r.bind("focus_mm", p.focus_mm, {1, 1000}, "best focus, projector depth");
}

void bind_render(ConfigReader& r, SceneConfig& c) {
  r.bind("render.samples_grid", c.render.grid, {1, 8}, "n*n samples a pixel and frame, each with its own instant");
  r.bind("render.every_shadow_ray", c.render.every_shadow_ray, "also where neighbouring samples agree");
  r.bind("light.ambient", c.render.light.ambient, {0, 1}, "ambient radiance times albedo, relative to full well");
  r.bind("light.reference_mm", c.render.light.reference_mm, {1, 1000}, "distance at which the exposure is set");
  r.bind("light.reference_fraction", c.render.light.reference_fraction, {0.01, 4},
         "full-well fraction of level 255 on albedo 0.8 facing at that distance");
  r.bind("camera.psf_sigma_px", c.psf_sigma_px, {0, 10}, "Gaussian point spread, camera px");
  r.bind("camera.temp_c", c.temp_c, {-20, 90}, "temperature stamped on the bursts");
  r.bind("texture.pattern", c.texture.pattern, kPatterns, "mottle or vessels");
  r.bind("texture.amplitude", c.texture.amplitude, {0, 0.5}, "relative change of the albedo");
  r.bind("texture.scale_mm", c.texture.scale_mm, {0.05, 100}, "size of a patch");
}

void bind_plate(ConfigReader r, RingPlateConfig& p) {
  r.bind("inner_mm", p.inner_mm, {0, 200}, "radius of the hole");
  r.bind("outer_mm", p.outer_mm, {1, 200}, "radius of the rim");
  r.bind("bumps", p.bumps, {0, 5000}, "balls sunk into the plate, by the seed");
  r.bind("bump_mm", p.bump_mm, {0.1, 50}, "least and largest diameter of a bump");
  r.bind("diameters_mm", p.diameters_mm, {0.1, 50}, "of the balls at the ends of the bar");
  r.bind("distance_mm", p.distance_mm, {1, 400}, "from ball to ball, along x about the middle");
  r.bind("height_mm", p.height_mm, {-50, 50}, "of the balls' centres above the plate");
  r.bind("rod_diameter_mm", p.rod_diameter_mm, {0, 50}, "from ball to ball; 0: none");
  r.bind("sigma_um", p.sigma_um, {0.01, 1000}, "standard deviation of the certified distance, drawn by the seed");
  if (p.inner_mm >= p.outer_mm) r.reject("inner_mm", "is not below outer_mm");
  if (p.bump_mm[0] > p.bump_mm[1]) r.reject("bump_mm", "is not least first");
}

void bind_object(ConfigReader r, SceneConfig& c) {
  r.bind("type", c.object, kObjects, "jaw, bite, ridge, plane, spheres, steps, plate, file or board");
  r.bind("plane.half_mm", c.plane.half_mm, {1, 500}, "half edge of the plane");
  r.bind("plane.strip_mm", c.plane.strip_mm, {0, 100}, "strips of the material and of plaster in turn; 0: none");
  r.bind("spheres.diameters_mm", c.spheres.diameters_mm, {0.1, 100}, "one a ball, along x");
  r.bind("spheres.pitch_mm", c.spheres.pitch_mm, {0.1, 200}, "centre to centre");
  r.bind("spheres.rod_diameter_mm", c.spheres.rod_diameter_mm, {0, 50}, "rod through the balls; 0: none");
  r.bind("steps.rises_mm", c.steps.rises_mm, {-50, 50}, "one a step, along x; negative: down");
  r.bind("steps.tread_mm", c.steps.tread_mm, {0.1, 100}, "length of a step");
  r.bind("steps.width_mm", c.steps.width_mm, {0.1, 200}, "along y");
  r.bind("steps.slot_widths_mm", c.steps.slot_widths_mm, {0.01, 20}, "slots in the block beside the stairs");
  r.bind("steps.slot_depth_mm", c.steps.slot_depth_mm, {0.01, 50}, "depth of the slots");
  bind_plate(r.table("plate"), c.plate);
  r.bind("jaw.side", c.jaw.side, kSides, "lower or upper");
  r.bind("jaw.last_tooth", c.jaw.last_tooth, {1, 7}, "1 central incisor ... 7 second molar");
  r.bind("jaw.both_sides", c.jaw.both_sides, "the whole arch instead of the right quadrant");
  r.bind("jaw.palate", c.jaw.palate, "upper jaw: the palate to its middle, not only the rim beside the teeth");
  r.bind("jaw.max_edge_mm", c.jaw.max_edge_mm, {0.02, 2}, "longest edge of the mesh");
  r.bind("jaw.from_mm", c.jaw.from_mm, {-70, 70}, "part of the arch to mesh, arc length from the midline");
  r.bind("jaw.to_mm", c.jaw.to_mm, {-70, 70}, "its end; from = to: all teeth");
  r.bind("jaw.enamel_albedo", c.jaw.enamel_albedo, {0, 1}, "reflectance of the teeth");
  r.bind("jaw.gum_albedo", c.jaw.gum_albedo, {0, 1}, "reflectance of the gum");
  r.bind("ridge.relief_um", c.ridge.relief_um, {0, 300}, "amplitude of the mucosa's fine relief; folds: 8 times that");
  r.bind("ridge.albedo", c.ridge.albedo, {0, 1}, "reflectance of the mucosa");
  r.bind("ridge.max_edge_mm", c.ridge.max_edge_mm, {0.02, 2}, "longest edge of the mesh");
  r.bind("ridge.from_mm", c.ridge.from_mm, {-kRidgeEndMm, kRidgeEndMm}, "part to mesh, arc length from the midline");
  r.bind("ridge.to_mm", c.ridge.to_mm, {-kRidgeEndMm, kRidgeEndMm}, "its end; from = to: the whole ridge");
  r.bind("file.path", c.file.path, "PLY, STL or OBJ in mm, relative to the scene file");
  r.bind("file.max_edge_mm", c.file.max_edge_mm, {0, 100}, "longer edges are split; 0: none");
  r.bind("file.albedo", c.file.albedo, {0, 1}, "reflectance");
}

void bind_bar(ConfigReader r, SphereBarConfig& b) {
  r.bind("arc_mm", b.arc_mm, {-70, 70}, "where along the arch the balls lie, from the midline; none: no artefact");
  r.bind("diameters_mm", b.diameters_mm, {0.1, 20}, "one a ball, or one for all");
  r.bind("offset_mm", b.offset_mm, {-25, 15}, "of the centres from the arch, outwards");
  r.bind("height_mm", b.height_mm, {-20, 20}, "of the centres above the gum margin");
  r.bind("rod_diameter_mm", b.rod_diameter_mm, {0, 10}, "straight from each ball to the next; 0: none");
  r.bind("albedo", b.albedo, {0, 1}, "reflectance");
  r.bind("sigma_um", b.sigma_um, {0.01, 1000}, "standard deviation of a certified distance, drawn by the seed");
}

void check_bar(ConfigReader& r, const SceneConfig& c) {
  const std::size_t balls = c.bar.arc_mm.size(), diameters = c.bar.diameters_mm.size();
  if (balls == 0) return;
  if (c.object != ObjectKind::kJaw && c.object != ObjectKind::kRidge) {
    r.reject("artefact.arc_mm", "the artefact lies beside a jaw or a ridge");
  }
  if (diameters != 1 && diameters != balls) r.reject("artefact.diameters_mm", "neither one nor as many as balls");
}

void bind_board(ConfigReader r, SceneConfig& c) {
  DotBoardConfig& b = c.board;
  r.bind("target", c.board_target, "target.json with the grid, relative to the scene file");
  r.bind("cols", b.cols, {3, 100}, "dots along x");
  r.bind("rows", b.rows, {3, 100}, "dots along y");
  r.bind("pitch_mm", b.pitch_mm, {0.05, 100}, "from dot to dot");
  r.bind("radius_mm", b.radius_mm, {0.01, 50}, "of a dot");
  r.bind("margin_mm", b.margin_mm, {0, 100}, "from the outermost dots' centres to the edge");
  r.bind("dot_error_um", b.dot_error_um, {0, 1000}, "error of the print, rms an axis");
  r.bind("bow_um", b.bow_um, {-5000, 5000}, "rise of the middle over the corners");
  r.bind("doubled", b.is_doubled, "a second grid beside the first");
  r.bind("dot_albedo", b.dot_albedo, {0, 1}, "reflectance of the dots");
  r.bind("ground_albedo", b.ground_albedo, {0, 1}, "reflectance between them");
}

void bind_calibration(ConfigReader r, CalibrationConfig& c) {
  r.bind("poses", c.poses, {1, 99}, "stands of the board, drawn by the seed");
  r.bind("frames", c.frames, {1, 1000}, "averaged into each picture of a calibration folder");
  r.bind("fringes", c.has_fringes, "off: a folder has white and black pictures only");
  r.bind("sweeps", c.sweeps, {1, 100}, "live: how often all patterns are shown at a stand");
}

void check(ConfigReader& r, const SceneConfig& c) {
  const bool shows_board = c.object == ObjectKind::kBoard;
  if (c.path == PathKind::kCalibration ? !shows_board : shows_board && c.path != PathKind::kMount) {
    r.reject("path.type", "a calibration path goes with object.type = board, which otherwise only a mount shows");
  }
  if (c.jaw.palate && c.jaw.side != JawSide::kUpper) r.reject("object.jaw.palate", "only the upper jaw has one");
  if (2 * c.board.radius_mm >= c.board.pitch_mm) r.reject("board.radius_mm", "the dots touch");
  if (c.object == ObjectKind::kFile && c.file.path.empty()) r.reject("object.type", "object.file.path is not given");
  if (c.timing.exposure_ms > c.timing.frame_period_ms) r.reject("timing.exposure_ms", "longer than the frame period");
  if (3 * c.timing.frame_period_ms + c.timing.exposure_ms > 1000.0 / c.timing.burst_rate_hz) {
    r.reject("timing.burst_rate_hz", "four frames take longer than a burst period");
  }
  check_bar(r, c);
}

}  // namespace

void bind_scene(ConfigReader& reader, SceneConfig& config) {
  reader.bind("rig", config.rig_path, "rig.json of the simulated probe, relative to the scene file");
  reader.bind("seed", config.seed, {0, INT64_MAX}, "patient, path, tremor and noise");
  bind_effects(reader.table("effects"), config.effects);
  bind_timing(reader.table("timing"), config.timing);
  bind_projector(reader.table("projector"), config.projector);
  bind_render(reader, config);
  bind_object(reader.table("object"), config);
  bind_look(reader, config);
  bind_bar(reader.table("artefact"), config.bar);
  bind_fault(reader, config);
  bind_board(reader.table("board"), config);
  bind_calibration(reader.table("calibration"), config.calibration);
  bind_passing(reader, config);
  bind_path(reader, config);
  bind_mount(reader, config);
  check(reader, config);
}

Result<SceneConfig> load_scene(const std::string& path, const std::vector<std::string>& overrides) {
  ENAMEL_TRY_ASSIGN(ConfigReader reader, ConfigReader::from_file(path));
  for (const auto& o : overrides) ENAMEL_TRY(reader.set(o));
  SceneConfig config;
  bind_scene(reader, config);
  ENAMEL_TRY(reader.finish());
  const auto resolve = [&](std::string& p) {
    if (!p.empty()) p = (std::filesystem::path(path).parent_path() / p).lexically_normal().string();
  };
  resolve(config.rig_path);
  resolve(config.file.path);
  resolve(config.board_target);
  if (!config.board_target.empty()) ENAMEL_TRY(read_target(config.board_target, config.board));
  return config;
}

}  // namespace enamel::twin
