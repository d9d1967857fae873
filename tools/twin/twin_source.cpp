#include "tools/twin/twin_source.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/model/pattern.hpp"
#include "tools/twin/board/board_source.hpp"
#include "tools/twin/mount/mount_path.hpp"
#include "tools/twin/render/seen.hpp"

namespace enamel::twin {
namespace {

constexpr double kTruthBallEdgeMm = 0.1;

TremorConfig effective_tremor(const SceneConfig& c) {
  TremorConfig t = c.tremor;
  // Stands before an artefact are held by a stage, not by a hand.
  t.enabled = c.effects.tremor && c.path == PathKind::kArch;
  return t;
}

std::unique_ptr<Trajectory> make_path(const SceneConfig& c, const ArchShape& shape) {
  if (c.path == PathKind::kViews) return make_views(c.views, c.timing);
  if (c.path == PathKind::kMount) return make_mount_path(mount_poses(drive(c.mount, c.seed)), c.mount, c.timing);
  return make_arch_path(c.arch_path, Arch(shape), c.timing);
}

BurstInstants since(BurstInstants instants, double start_s) {
  instants.mid -= start_s;
  for (std::vector<double>& frame : instants.frames) {
    for (double& t_s : frame) t_s -= start_s;
  }
  return instants;
}

}  // namespace

struct TwinSource::Impl {
  SceneConfig config;
  Instrument instrument;
  RayScene scene;
  std::unique_ptr<RayScene> scene_later;  ///< from a fault's time on; null without one
  TriSurface truth_surface;
  BurstRenderer renderer;
  std::unique_ptr<BurstRenderer> renderer_later;
  SeenCounter seen;
  SensorConfig sensor;
  Tremor tremor;
  std::unique_ptr<Trajectory> path;
  MoverStage movers;
  std::string scene_json, certificate_json;
  std::uint64_t total = 0, next = 0;
  BurstTruth truth;

  Impl(const SceneConfig& c, const calib::Rig& rig, Body body)
      : config(c),
        instrument(rig, effective_projector(c)),
        scene(std::move(body.surroundings)),
        scene_later(body.later ? std::make_unique<RayScene>(std::move(*body.later)) : nullptr),
        truth_surface(truth_mesh(scene.surroundings(), kTruthBallEdgeMm)),
        renderer(instrument, scene, effective_render(c)),
        renderer_later(scene_later ? std::make_unique<BurstRenderer>(instrument, *scene_later, effective_render(c))
                                   : nullptr),
        seen(instrument, truth_surface),
        sensor(effective_sensor(c, *rig.noise)),
        tremor(effective_tremor(c), c.seed),
        path(make_path(c, body.arch)),
        movers(effective_movers(c), c.seed, scene, *path, scan_s()),
        scene_json(std::move(body.description_json)),
        certificate_json(std::move(body.certificate_json)) {
    total = bursts();
  }

  [[nodiscard]] std::uint64_t bursts() const {
    return static_cast<std::uint64_t>(config.timing.bursts > 0 ? config.timing.bursts : path->bursts());
  }
  /// From the start of the hand's way to the last burst.
  [[nodiscard]] double scan_s() const {
    return static_cast<double>(path->slot(bursts())) / config.timing.burst_rate_hz;
  }

  [[nodiscard]] Pose pose_at(double device_s) const {
    const double t = device_s - config.timing.start_s;
    return path->pose_at(t) * tremor.displacement(t);
  }

  [[nodiscard]] std::int64_t t_mid_ns(std::uint64_t n) const { return mid_burst_ns(config.timing, path->slot(n), n); }

  /// On the device's clock, s; what the effects leave of them.
  [[nodiscard]] BurstInstants instants(std::uint64_t n) const {
    const int count = config.render.grid * config.render.grid;
    BurstInstants out;
    out.mid = 1e-9 * static_cast<double>(t_mid_ns(n));
    for (int k = 0; k < 4; ++k) {
      const double start = 1e-9 * static_cast<double>(exposure_start_ns(config.timing, path->slot(n), k));
      for (int i = 0; i < count; ++i) {
        const double share = config.effects.exposure ? (i + 0.5) / count : 0.5;
        const double at = config.effects.motion ? start + share * 1e-3 * exposure_ms(config.timing, n) : out.mid;
        out.frames[static_cast<std::size_t>(k)].push_back(at);
      }
    }
    return out;
  }

  [[nodiscard]] Passing passing(std::uint64_t n) const {
    Passing out;
    out.guests = movers.at(since(instants(n), config.timing.start_s));
    for (int k = 0; k < 4; ++k) {
      const double start = 1e-9 * static_cast<double>(exposure_start_ns(config.timing, path->slot(n), k));
      out.lamp[static_cast<std::size_t>(k)] =
          lamp_factor(config.render.light.lamp, start, 1e-3 * exposure_ms(config.timing, n));
    }
    return out;
  }

  [[nodiscard]] std::array<std::vector<float>, 4> light(const BurstPoses& poses, std::uint64_t n,
                                                        const Passing& passing) const {
    const double t_s = 1e-9 * static_cast<double>(t_mid_ns(n)) - config.timing.start_s;
    const bool later = renderer_later && t_s >= config.jaw.fault.move_at_s;
    auto out = (later ? *renderer_later : renderer).render(poses, passing);
    const auto& camera = instrument.rig.camera;
    const double fog = config.effects.fog ? fog_at(config.fog, t_s, config.seed) : 0.0;
    apply_fog(config.fog, fog, camera.width, camera.height, out);
    for (auto& image : out) apply_psf(image, camera.width, camera.height, sensor.psf_sigma_px);
    return out;
  }

  [[nodiscard]] fw::SimFrames digital(std::array<std::vector<float>, 4> mean, std::uint64_t n, double share = 1) const {
    // Light is told as full-well fraction at the scene's exposure.
    const double share_of_exposure = share * exposure_ms(config.timing, n) / config.timing.exposure_ms;
    const auto full_well = static_cast<float>(sensor.full_well_e * share_of_exposure);
    fw::SimFrames out;
    for (int k = 0; k < 4; ++k) {
      auto& image = mean[static_cast<std::size_t>(k)];
      for (float& e : image) e *= full_well;
      out[static_cast<std::size_t>(k)] = digitise(image, sensor, {config.seed, n, k});
    }
    return out;
  }
};

TwinSource::TwinSource(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
TwinSource::~TwinSource() = default;

Result<std::unique_ptr<TwinSource>> TwinSource::create(const SceneConfig& config) {
  if (config.rig_path.empty()) return fail(ErrorCode::kRigMissing, "the scene names no rig");
  ENAMEL_TRY_ASSIGN(const calib::Rig rig, calib::load_rig(config.rig_path));
  return create(config, rig);
}

Result<std::unique_ptr<TwinSource>> TwinSource::create(const SceneConfig& config, const calib::Rig& rig) {
  ENAMEL_TRY_ASSIGN(const calib::Rig effective, apply_effects(rig, config.effects));
  if (!effective.noise) return fail(ErrorCode::kRigInvalid, "the twin needs `noise` in the rig");
  if (!calib::is_burst_set(effective.patterns)) {
    return fail(ErrorCode::kPatternSet, "the twin renders sets of four frames, the rig describes a calibration set");
  }
  if (config.path == PathKind::kCalibration) {
    return fail(ErrorCode::kConfigValue, "path.type = calibration shows a board: use `enamel-twin calibrate`");
  }
  ENAMEL_TRY_ASSIGN(Body body, make_body(config));
  auto impl = std::make_unique<Impl>(config, effective, std::move(body));
  if (impl->total == 0) return fail(ErrorCode::kConfigValue, "path.from_s, pauses and gaps leave no burst to take");
  return std::unique_ptr<TwinSource>(new TwinSource(std::move(impl)));
}

const std::string& TwinSource::rig_text() const { return impl_->instrument.rig.text; }
std::optional<std::uint64_t> TwinSource::count() const { return impl_->total; }
std::int64_t TwinSource::t_mid_ns(std::uint64_t n) const { return impl_->t_mid_ns(n); }
const BurstTruth& TwinSource::truth() const { return impl_->truth; }
const TriSurface& TwinSource::surface() const { return impl_->truth_surface; }
std::span<const std::uint8_t> TwinSource::seen() const { return impl_->seen.counts(); }
const std::string& TwinSource::scene_json() const { return impl_->scene_json; }
const std::string& TwinSource::certificate_json() const { return impl_->certificate_json; }
const calib::Rig& TwinSource::rig() const { return impl_->instrument.rig; }

BurstPoses TwinSource::poses(std::uint64_t n) const {
  const BurstInstants instants = impl_->instants(n);
  BurstPoses out;
  out.mid = impl_->pose_at(instants.mid);
  out.is_static = true;
  for (std::size_t k = 0; k < instants.frames.size(); ++k) {
    for (const double at : instants.frames[k]) {
      out.frames[k].push_back(impl_->pose_at(at));
      out.is_static = out.is_static && out.frames[k].back().matrix() == out.mid.matrix();
    }
  }
  return out;
}

std::array<std::vector<float>, 4> TwinSource::mean_light(std::uint64_t n) const {
  return impl_->light(poses(n), n, impl_->passing(n));
}

fw::SimBurst TwinSource::planned(std::uint64_t n) const {
  const Impl& m = *impl_;
  fw::SimBurst burst;
  burst.burst_index = n;
  burst.exposure_us = static_cast<std::uint32_t>(std::lround(1e3 * exposure_ms(m.config.timing, n)));
  burst.temp_c = m.config.temp_c;
  burst.width = m.instrument.rig.camera.width;
  burst.height = m.instrument.rig.camera.height;
  burst.bit_depth = m.sensor.bits;
  for (int k = 0; k < 4; ++k) {
    burst.t_exposure_ns[static_cast<std::size_t>(k)] = exposure_start_ns(m.config.timing, m.path->slot(n), k);
  }
  return burst;
}

fw::SimFrames TwinSource::frames(std::uint64_t n, const BurstPoses& poses, double share) const {
  return impl_->digital(impl_->light(poses, n, impl_->passing(n)), n, share);
}

void TwinSource::count_seen(const Pose& T_model_cam) {
  impl_->seen.add(T_model_cam, impl_->renderer.truth(T_model_cam, {}));
}

Result<std::optional<fw::SimBurst>> TwinSource::next() {
  Impl& m = *impl_;
  if (m.next >= m.total) return std::optional<fw::SimBurst>();
  const std::uint64_t n = m.next++;
  const Passing passing = m.passing(n);
  const BurstPoses at = poses(n);
  fw::SimBurst burst = planned(n);
  burst.frames = m.digital(m.light(at, n, passing), n);
  m.truth.burst_index = n;
  m.truth.t_mid_ns = t_mid_ns(n);
  m.truth.T_model_cam = at.mid;
  m.truth.maps = m.renderer.truth(m.truth.T_model_cam, passing.guests.mid);
  m.truth.movers.clear();
  for (std::size_t g = 0; g < passing.guests.movers.size(); ++g) {
    const auto seen = std::ranges::count(m.truth.maps.mover, static_cast<std::uint8_t>(g + 1));
    m.truth.movers.push_back({passing.guests.movers[g], static_cast<std::size_t>(seen)});
  }
  m.seen.add(m.truth.T_model_cam, m.truth.maps);
  return std::optional<fw::SimBurst>(std::move(burst));
}

Result<std::unique_ptr<fw::BurstSource>> open_twin_source(const std::string& scene_path,
                                                          std::optional<std::uint64_t> seed) {
  ENAMEL_TRY_ASSIGN(SceneConfig scene, load_scene(scene_path));
  if (seed) scene.seed = *seed;
  if (scene.path == PathKind::kCalibration) {
    ENAMEL_TRY_ASSIGN(auto board, BoardSource::create(scene));
    return std::unique_ptr<fw::BurstSource>(std::move(board));
  }
  ENAMEL_TRY_ASSIGN(auto source, TwinSource::create(scene));
  return std::unique_ptr<fw::BurstSource>(std::move(source));
}

}  // namespace enamel::twin
