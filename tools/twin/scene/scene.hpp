// A scene file: what stands before the probe, how the probe moves, which physical effects are on. Keys:
// docs/twin-scene.md.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/rig.hpp"
#include "protocol/base/config.hpp"
#include "tools/twin/jaw/jaw.hpp"
#include "tools/twin/jaw/mouth.hpp"
#include "tools/twin/jaw/ridge.hpp"
#include "tools/twin/jaw/sphere_bar.hpp"
#include "tools/twin/mount/mount_config.hpp"
#include "tools/twin/movers/mover_config.hpp"
#include "tools/twin/optics/fog.hpp"
#include "tools/twin/optics/projector.hpp"
#include "tools/twin/path/trajectory.hpp"
#include "tools/twin/render/optics_model.hpp"
#include "tools/twin/surface/artefacts.hpp"
#include "tools/twin/surface/dot_board.hpp"
#include "tools/twin/surface/film.hpp"
#include "tools/twin/surface/ring_plate.hpp"
#include "tools/twin/surface/texture.hpp"

namespace enamel::twin {

enum class ObjectKind : std::uint8_t { kJaw, kRidge, kPlane, kSpheres, kSteps, kPlate, kFile, kBoard, kBite };
enum class PathKind : std::uint8_t { kViews, kArch, kCalibration, kMount };

struct FileObjectConfig {
  std::string path;          ///< PLY, STL or OBJ, mm
  double max_edge_mm = 0.3;  ///< longer edges are split; 0: left as they are
  double albedo = 0.8;
};

/// How a board is shown to the probe for calibration.
struct CalibrationConfig {
  int poses = 12;
  int frames = 16;                        ///< averaged into each picture of a calibration folder
  int sweeps = 4;                         ///< live: how often the whole pattern set is shown at each pose
  bool has_fringes = true;                ///< off: a folder has white and black pictures only
  std::vector<int> cycles{1, 4, 16, 64};  ///< periods across the projector, rising
  double mean = 127, amplitude = 120;     ///< 8-bit levels of the fringes
};

/// true = simulated. Off means ideal, never another device: with lens_distortion off the rig has no distortion either.
struct Effects {
  bool round_levels = true, gamma = true, defocus = true, lens_distortion = true, falloff = true, ambient = true;
  bool shadow = true, texture = true, camera_psf = true;
  bool motion = true;    ///< off: the probe stands still during a burst, at its mid-burst pose
  bool exposure = true;  ///< off: an exposure is an instant, in its middle
  bool tremor = true, shot_noise = true, read_noise = true;
  bool adc = true;           ///< off: 16-bit samples, 256 to one step of the rig's converter
  bool translucency = true;  ///< off: all light returns from the surface
  bool gloss = true;         ///< off: no mirror light of the solid surface
  bool film = true;          ///< off: dry
  bool movers = true, fog = true, lamp = true;
};

/// What a body is made of.
struct LookConfig {
  int material = 0;  ///< MaterialId of the whole body, or kMouth
  static constexpr int kPlaster = 0, kMouth = static_cast<int>(kMaterials);
  MaterialTable materials = default_materials();
  MouthConfig mouth;
  FilmConfig film;
};

struct SceneConfig {
  std::string rig_path;  ///< relative to the scene file
  std::uint64_t seed = 1;
  Effects effects;
  TimingConfig timing;
  ProjectorConfig projector;
  double psf_sigma_px = 0.6;
  TextureConfig texture;
  LookConfig look;
  double temp_c = 32.0;
  RenderConfig render;
  ObjectKind object = ObjectKind::kPlane;
  PlaneConfig plane;
  SpheresConfig spheres;
  StepsConfig steps;
  RingPlateConfig plate;
  JawConfig jaw;  ///< of a bite both jaws
  RidgeConfig ridge;
  SphereBarConfig bar;  ///< beside a jaw or ridge
  FileObjectConfig file;
  std::string board_target;  ///< target.json that stands for the board's grid; empty: `board` as stated
  DotBoardConfig board;
  CalibrationConfig calibration;
  std::vector<MoverConfig> movers;
  FogConfig fog;
  PathKind path = PathKind::kViews;
  std::vector<ViewConfig> views;
  ArchPathConfig arch_path;
  TremorConfig tremor;
  MountConfig mount;
};

/// Binds every key. Relative paths are left relative. The caller calls reader.finish().
void bind_scene(ConfigReader& reader, SceneConfig& config);

/// Reads a scene file; paths in it come back resolved against the scene's folder. overrides: "key=value", as if they
/// stood in the file. Errors: kFileNotFound, kConfigSyntax, kConfigUnknownKey, kConfigValue.
[[nodiscard]] Result<SceneConfig> load_scene(const std::string& path, const std::vector<std::string>& overrides = {});

/// Rig as the effects leave it: distortion zero and the text rewritten when lens_distortion is off, 16-bit converter
/// when adc is off. `text` is untouched when neither is. Errors: kRigInvalid.
[[nodiscard]] Result<calib::Rig> apply_effects(const calib::Rig& rig, const Effects& effects);

/// What the effects leave of projector, light and sensor.
[[nodiscard]] ProjectorConfig effective_projector(const SceneConfig& config);
[[nodiscard]] RenderConfig effective_render(const SceneConfig& config);
/// None where they are switched off; of mucosa where the mouth is not plaster.
[[nodiscard]] std::vector<MoverConfig> effective_movers(const SceneConfig& config);
[[nodiscard]] SensorConfig effective_sensor(const SceneConfig& config, const calib::NoiseValues& noise);

/// Body in model coordinates, texture applied. Errors of mesh files.
struct Body {
  Surroundings surroundings;
  std::optional<Surroundings> later{};  ///< from FaultConfig::move_at_s on
  ArchShape arch;                       ///< of a jaw or ridge
  Dentition dentition;                  ///< of a jaw
  std::string description_json;
  std::string certificate_json;  ///< of the known artefact; empty without one
};
[[nodiscard]] Result<Body> make_body(const SceneConfig& config);

}  // namespace enamel::twin
