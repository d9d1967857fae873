#include "host/app/desktop/desktop_scan.hpp"

#include <memory>
#include <optional>
#include <utility>

#include "calib/model/measuring_rig.hpp"
#include "host/app/desktop/open_axes.hpp"
#include "host/app/desktop/stop_by_signal.hpp"
#include "host/app/desktop/write_base.hpp"
#include "host/app/out_folder.hpp"
#include "host/app/run_session.hpp"
#include "host/desktop/desktop_session.hpp"
#include "host/desktop/live_stops.hpp"
#include "host/ingest/probe_facts.hpp"
#include "host/record/calibration_attachment.hpp"
#include "protocol/base/log.hpp"

namespace enamel::app {
namespace {

constexpr const char* kAutoPlan = "auto";

host::StopTakerConfig taker_config(const DesktopScan& scan, const LoadedConfig& config, Clock& clock) {
  host::StopTakerConfig out;
  out.link.serial = scan.scan.serial;
  out.feed.session_id = host::new_session_id(clock);
  out.feed.find_timeout = nanoseconds(scan.scan.wait_seconds);
  out.bursts = scan.bursts;
  out.exposures = config.desktop.exposures;
  if (scan.scan.record) out.recording_path = scan.scan.run.out + "/capture.mcap";
  out.program = "enamel " ENAMEL_VERSION;
  out.config_text = config.text;
  return out;
}

/// That measures, and what the report says of it.
struct Measuring {
  calib::Rig rig;
  std::optional<Calibration> calibration;  ///< where it is not the probe's own
};

Result<Measuring> rig_of(const DesktopScan& scan, const proto::DeviceInfo& info) {
  const std::string text(info.calibration_blob.begin(), info.calibration_blob.end());
  ENAMEL_TRY_ASSIGN(calib::Rig rig, calib::parse_rig(text));
  if (scan.scan.rig_path.empty()) return Measuring{std::move(rig), std::nullopt};
  ENAMEL_TRY_ASSIGN(Calibration calibration, load_calibration(scan.scan.rig_path));
  ENAMEL_TRY_ASSIGN(rig, calib::measuring_rig(calibration.rig, rig));
  return Measuring{std::move(rig), std::move(calibration)};
}

/// What a replay needs to lay it again.
void attach_to(host::StopTaker& taker, const MountFile& mount, const Measuring& measuring) {
  taker.attach(kMountAttachment, "application/json", mount.text);
  if (!measuring.calibration) return;
  taker.attach(host::kCalibrationAttachment, "application/json", measuring.calibration->rig.text);
  taker.attach(host::kCalibrationReportAttachment, "application/json", measuring.calibration->report_json);
}

/// None for the plan that is made as it goes. The axes' limits are known, and nothing has moved.
Result<std::optional<host::StopPlan>> fixed_plan(const std::string& plan, const motion::AxesLimits& limits) {
  if (plan == kAutoPlan) return std::optional<host::StopPlan>();
  if (plan.find('.') != std::string::npos || plan.find('/') != std::string::npos) {
    ENAMEL_TRY_ASSIGN(auto read, host::read_plan(plan, limits));
    return std::optional(std::move(read));
  }
  ENAMEL_TRY_ASSIGN(auto named, host::named_plan(plan));
  ENAMEL_TRY(host::check_plan(named, limits));
  return std::optional(std::move(named));
}

std::unique_ptr<host::StopChooser> chooser_of(std::optional<host::StopPlan> fixed, const motion::AxesLimits& limits,
                                              const calib::Mount& mount, const calib::Rig& rig,
                                              const pipeline::PlannerConfig& planner) {
  if (fixed) return std::make_unique<host::FixedPlan>(std::move(*fixed));
  return std::make_unique<host::PlannedStops>(pipeline::StopPlanner(mount, rig, host::within(planner, limits)));
}

Result<void> home(motion::Axes& axes, double within_s) {
  const StopBySignal guard(axes);
  log::info("desktop", "homing the table");
  return axes.home(nanoseconds(within_s));
}

Result<proto::DeviceInfo> start(host::StopTaker& taker) {
  const StopBySignal guard(taker);
  return taker.start();
}

/// A scan that no base can be put under is a scan all the same.
void add_base(const std::string& run, const calib::Mount& mount) {
  host::BaseConfig config;
  config.up = up_of(mount);
  const auto closed = write_base_of_run(run, config);
  if (!closed) log::error("base", "no closed mesh: {}", closed.error().message());
}

}  // namespace

Result<int> run_desktop_scan(const DesktopScan& scan) {
  SteadyClock clock;
  ENAMEL_TRY_ASSIGN(const LoadedConfig config, load_config(scan.scan.run));
  ENAMEL_TRY_ASSIGN(const MountFile mount, mount_for(scan.desktop.mount, nullptr));
  ENAMEL_TRY_ASSIGN(const OutFolder folder, OutFolder::open(scan.scan.run.out));
  ENAMEL_TRY(keep_recording(scan.scan, folder));
  folder.clear_results();
  ENAMEL_TRY_ASSIGN(const auto link, dds::participant_options(scan.scan.link, dds::LinkEnd::kHost));
  ENAMEL_TRY_ASSIGN(const auto participant, dds::Participant::create(link));
  ENAMEL_TRY_ASSIGN(const auto axes, open_axes(scan.port, scan.profile, clock));
  ENAMEL_TRY_ASSIGN(auto fixed, fixed_plan(scan.plan, axes->limits()));
  // Nothing has moved until here.
  ENAMEL_TRY(home(*axes, scan.home_within_s));
  ENAMEL_TRY_ASSIGN(auto taker, host::StopTaker::create(participant, taker_config(scan, config, clock), *axes, clock));
  ENAMEL_TRY_ASSIGN(const proto::DeviceInfo info, start(*taker));
  ENAMEL_TRY_ASSIGN(const Measuring measuring, rig_of(scan, info));
  attach_to(*taker, mount, measuring);
  ENAMEL_TRY_ASSIGN(auto model, desktop_model(measuring.rig, measuring.rig.crc32, mount.mount, config, scan.desktop,
                                              scan.scan.run.workers));
  auto plan = chooser_of(std::move(fixed), axes->limits(), mount.mount, measuring.rig, config.desktop.planner);
  host::DesktopRun about{.simulated = host::says_simulated(info),
                         .device_serial = info.serial,
                         .scanned_at = {},
                         .preview_model = !scan.scan.run.headless};
  host::DesktopSession session(std::move(model), std::make_unique<host::LiveStops>(std::move(taker), std::move(plan)),
                               std::move(about), clock);
  const SessionRun run{.run = scan.scan.run,
                       .title = "enamel desktop scan",
                       .window = !scan.scan.run.headless,
                       .calibration = measuring.calibration,
                       .limits = config.calibration,
                       .config_text = config.text,
                       .truth = scan.scan.truth,
                       .notes = scan.scan.notes};
  ENAMEL_TRY_ASSIGN(const int code, run_session(session, run, clock));
  if (scan.base) add_base(scan.scan.run.out, mount.mount);
  return code;
}

}  // namespace enamel::app
