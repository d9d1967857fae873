#include "host/app/scan_run.hpp"

#include <optional>

#include "host/app/calibration.hpp"
#include "host/app/run_session.hpp"
#include "host/session/live_session.hpp"
#include "protocol/base/file.hpp"

namespace enamel::app {

namespace {

host::LiveSessionConfig session_config(const ScanRun& scan, const LoadedConfig& config,
                                       const std::optional<Calibration>& calibration, Clock& clock) {
  host::LiveSessionConfig c;
  c.link.serial = scan.serial;
  c.feed.session_id = static_cast<std::uint32_t>(to_ns(clock.now()) / 1'000'000) | 1U;
  c.feed.start_at_once = scan.start_at_once;
  c.feed.find_timeout = Nanoseconds(static_cast<std::int64_t>(scan.wait_seconds * 1e9));
  c.pipeline = config.pipeline;
  if (calibration) {
    c.calibration = calibration->rig;
    c.calibration_report = calibration->report_json;
  }
  c.config_text = config.text;
  c.program = "enamel " ENAMEL_VERSION;
  if (scan.record) c.recording_path = scan.run.out + "/capture.mcap";
  c.workers = scan.run.workers;
  c.preview_model = !scan.run.headless;
  return c;
}

}  // namespace

Result<int> run_scan(const ScanRun& scan) {
  SteadyClock clock;
  ENAMEL_TRY_ASSIGN(const LoadedConfig config, load_config(scan.run));
  std::optional<Calibration> calibration;
  if (!scan.rig_path.empty()) {
    ENAMEL_TRY_ASSIGN(calibration, load_calibration(scan.rig_path));
  }
  ENAMEL_TRY(make_folder(scan.run.out));
  ENAMEL_TRY_ASSIGN(const auto participant, dds::Participant::create({.domain = 77, .tag = scan.dds_tag}));
  ENAMEL_TRY_ASSIGN(const auto session,
                    host::LiveSession::create(participant, session_config(scan, config, calibration, clock), clock));
  return run_session(*session,
                     {.run = scan.run,
                      .window = !scan.run.headless,
                      .seconds = scan.seconds,
                      .calibration = calibration,
                      .limits = config.calibration,
                      .config_text = config.text,
                      .truth = scan.truth,
                      .notes = scan.notes},
                     clock);
}

}  // namespace enamel::app
