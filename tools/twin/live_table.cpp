#include "tools/twin/live_table.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <fstream>
#include <utility>

#include "protocol/base/file.hpp"
#include "tools/twin/degrees.hpp"
#include "tools/twin/surface/mesh_file.hpp"
#include "tools/twin/twin_source.hpp"

namespace enamel::twin {
namespace {

// Angles at which the controller's homing leaves the table: those of config/desktop/grbl.toml.
constexpr std::array<double, 2> kHomeDeg{0.0, -30.0};
// A render takes under a second on an idle machine; a burst under way at a pause is waited for on a busy one, too.
constexpr Nanoseconds kLateness{8'000'000'000};
constexpr double kFaultShare = 0.5;

constexpr std::array<std::pair<std::string_view, GrblFault>, 5> kFaults{{{"hard-limit", GrblFault::kHardLimit},
                                                                         {"restart", GrblFault::kRestart},
                                                                         {"power-off", GrblFault::kPowerOff},
                                                                         {"unplug", GrblFault::kUnplug},
                                                                         {"hang", GrblFault::kHang}}};

HostTime host_of(DeviceTime t) { return host_time(to_ns(t)); }

class LiveTable final : public fw::BurstSource {
 public:
  LiveTable(std::unique_ptr<TwinSource> twin, const SceneConfig& scene, const TableFault& fault)
      : twin_(std::move(twin)), mount_(scene.mount, scene.seed, fault.lost) {}
  ~LiveTable() override {
    controller_.reset();
    if (surface_.empty()) return;
    // Nobody is left to be told of a disk that is full: the file is not there.
    static_cast<void>(write_file(surface_, write_ply(twin_->surface(), twin_->seen())));
  }
  LiveTable(const LiveTable&) = delete;
  LiveTable& operator=(const LiveTable&) = delete;

  [[nodiscard]] Result<void> start(const LiveTableOptions& options, Clock& clock) {
    if (!options.truth.empty()) {
      truth_.open(options.truth, std::ios::trunc);
      truth_ << kTableTruthHeader << std::endl;
      if (!truth_) return fail(ErrorCode::kFileWrite, options.truth + ": choose a file in a folder of yours");
    }
    surface_ = options.surface;
    ENAMEL_TRY_ASSIGN(PseudoTerminal terminal, PseudoTerminal::open());
    ENAMEL_TRY_ASSIGN(PortName name, PortName::create(options.port, terminal.port()));
    name_.emplace(std::move(name));
    GrblModelSetup setup;
    setup.witness = [this](const GrblMotion& m) {
      mount_.motors_at({m.at, {kHomeDeg[0] + m.from_home[0], kHomeDeg[1] + m.from_home[1]}, m.homings, m.movements});
    };
    controller_ = std::make_unique<GrblModel>(std::move(terminal), std::move(setup), clock);
    const TableFault& fault = options.fault;
    if (fault.fault != GrblFault::kNone) controller_->arm(fault.fault, kFaultShare, fault.movement);
    return {};
  }

  [[nodiscard]] const std::string& rig_text() const override { return twin_->rig_text(); }
  [[nodiscard]] std::optional<std::uint64_t> count() const override { return std::nullopt; }
  [[nodiscard]] Nanoseconds lateness() const override { return kLateness; }

  [[nodiscard]] Result<std::optional<fw::SimBurst>> next() override {
    const std::uint64_t n = next_++;
    fw::SimBurst burst = twin_->planned(n);
    burst.expose = [this, n](const fw::SimExposure& when) { return expose(n, when); };
    return std::optional<fw::SimBurst>(std::move(burst));
  }

 private:
  fw::SimFrames expose(std::uint64_t n, const fw::SimExposure& when) {
    const TableTruth at = mount_.at(host_of(when.mid));
    const TableTruth first = mount_.at(host_of(when.first));
    const TableTruth last = mount_.at(host_of(when.mid + (when.mid - when.first)));
    const auto stood_at = [&](const TableTruth& other) {
      return !other.is_moving && other.stop.rot == at.stop.rot && other.stop.swing == at.stop.swing;
    };
    BurstPoses poses;
    poses.mid = T_model_camera(mount_.mount(), at.stop);
    poses.is_static = true;
    const std::size_t instants = twin_->poses(0).frames[0].size();
    for (auto& frame : poses.frames) frame.assign(instants, poses.mid);
    const bool is_moving = at.is_moving || !stood_at(first) || !stood_at(last);
    write_truth(when, at.stop, is_moving, poses.mid);
    if (!surface_.empty() && !is_moving) twin_->count_seen(poses.mid);
    return twin_->frames(n, poses, when.share);
  }

  void write_truth(const fw::SimExposure& when, const StopTruth& stop, bool is_moving, const Pose& T_model_cam) {
    if (!truth_.is_open()) return;
    const Eigen::Vector3d t = T_model_cam.translation();
    const Eigen::Quaterniond q = Eigen::Quaterniond(T_model_cam.linear()).normalized();
    truth_ << fmt::format("{},{},{},{:.6f},{:.6f},{:.6f},{:.6f},", to_ns(when.first), to_ns(when.mid),
                          is_moving ? 1 : 0, stop.rot_cmd / kRadPerDeg, stop.swing_cmd / kRadPerDeg,
                          stop.rot / kRadPerDeg, stop.swing / kRadPerDeg)
           << fmt::format("{:.9f},{:.9f},{:.9f},{:.12f},{:.12f},{:.12f},{:.12f}", t.x(), t.y(), t.z(), q.x(), q.y(),
                          q.z(), q.w())
           << std::endl;  // a reader of a probe that was killed finds every burst that it published
  }

  std::unique_ptr<TwinSource> twin_;
  LiveMount mount_;
  std::ofstream truth_;
  std::string surface_;
  std::optional<PortName> name_;
  std::unique_ptr<GrblModel> controller_;  ///< last: its thread tells mount_
  std::uint64_t next_ = 0;
};

}  // namespace

Result<TableFault> parse_table_fault(std::string_view text) {
  TableFault fault;
  if (text.empty()) return fault;
  const auto unusable = [&] {
    return fail(ErrorCode::kUsage, std::string(text) +
                                       " is no fault of the axes: give lose-step@N, hard-limit@N, "
                                       "restart@N, power-off@N, unplug@N or hang@N, with the number of "
                                       "the movement, from 1");
  };
  const std::size_t at = text.find('@');
  if (at == std::string_view::npos) return unusable();
  const std::string_view name = text.substr(0, at), number = text.substr(at + 1);
  int movement = 0;
  const auto read = std::from_chars(number.data(), number.data() + number.size(), movement);
  if (read.ec != std::errc{} || read.ptr != number.data() + number.size() || movement < 1) return unusable();
  if (name == "lose-step") {
    fault.lost.movement = movement;
    return fault;
  }
  for (const auto& [known, what] : kFaults) {
    if (name == known) fault.fault = what;
  }
  if (fault.fault == GrblFault::kNone) return unusable();
  fault.movement = movement;
  return fault;
}

Result<std::unique_ptr<fw::BurstSource>> open_live_table(const LiveTableOptions& options, Clock& clock) {
  ENAMEL_TRY_ASSIGN(SceneConfig scene, load_scene(options.scene));
  if (options.seed) scene.seed = *options.seed;
  if (scene.path != PathKind::kMount) {
    return fail(ErrorCode::kConfigValue, options.scene +
                                             ": axes move a mount: give a scene with path.type = mount, "
                                             "as config/scenes/desktop_arch.toml has");
  }
  // The scene's stops and their pauses are not followed: bursts come in the probe's rhythm.
  scene.mount.move_s = 0;
  ENAMEL_TRY_ASSIGN(auto twin, TwinSource::create(scene));
  auto table = std::make_unique<LiveTable>(std::move(twin), scene, options.fault);
  ENAMEL_TRY(table->start(options, clock));
  return std::unique_ptr<fw::BurstSource>(std::move(table));
}

}  // namespace enamel::twin
