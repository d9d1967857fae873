#include "host/app/scan_run.hpp"

#include <filesystem>
#include <optional>

#include "host/app/calibration.hpp"
#include "host/app/out_folder.hpp"
#include "host/app/run_session.hpp"
#include "host/ingest/probe_facts.hpp"
#include "host/record/burst_stream.hpp"
#include "host/record/calibration_attachment.hpp"
#include "host/record/session_stream.hpp"
#include "host/session/live_session.hpp"
#include "protocol/base/file.hpp"

namespace enamel::app {

namespace {

host::LiveSessionConfig session_config(const ScanRun& scan, const LoadedConfig& config,
                                       const std::optional<Calibration>& calibration, Clock& clock) {
  host::LiveSessionConfig c;
  c.link.serial = scan.serial;
  c.feed.session_id = host::new_session_id(clock);
  c.feed.start_at_once = scan.start_at_once;
  c.feed.find_timeout = Nanoseconds(static_cast<std::int64_t>(scan.wait_seconds * 1e9));
  c.pipeline = config.pipeline;
  if (calibration) {
    c.calibration = calibration->rig;
    c.calibration_report = calibration->report_json;
  }
  c.config_text = config.text;
  c.program = "enamel " ENAMEL_VERSION;
  if (scan.resume) c.resume = host::session_parts(scan.run.out);
  if (scan.record) c.recording_path = scan.resume ? host::next_part(scan.run.out) : scan.run.out + "/capture.mcap";
  c.workers = scan.run.workers;
  c.preview_model = !scan.run.headless;
  return c;
}

/// That measured so far, where it is not the probe's own.
Result<std::optional<Calibration>> recorded_calibration(const std::string& folder) {
  ENAMEL_TRY_ASSIGN(const auto stream, host::open_bursts(folder));
  if (!stream->attachment(host::kCalibrationAttachment)) return std::optional<Calibration>{};
  ENAMEL_TRY_ASSIGN(Calibration calibration, calibration_for("", *stream, folder));
  return std::optional<Calibration>(std::move(calibration));
}

}  // namespace

Result<void> keep_recording(const ScanRun& scan, const OutFolder& folder) {
  if (scan.resume && !folder.has_recording()) {
    return fail(ErrorCode::kFileNotFound, folder.path() + "/capture.mcap: there is no session to go on with");
  }
  if (scan.resume || !folder.has_recording()) return {};
  if (scan.may_replace_simulated) {
    const auto before = host::open_bursts(folder.path() + "/capture.mcap");
    // Of a demo that was killed before its first burst nothing can be read, and nothing is lost.
    if (!before ? before.error().code == ErrorCode::kCaptureInvalid : host::says_simulated((*before)->info())) {
      std::error_code ec;
      for (const std::string& part : host::session_parts(folder.path())) std::filesystem::remove(part, ec);
      return {};
    }
  }
  return fail(ErrorCode::kFileWrite, folder.path() +
                                         ": holds the recording of a scan, which is not written over; "
                                         "choose another folder, or go on with it by enamel scan --resume " +
                                         folder.path());
}

Result<int> run_scan(const ScanRun& scan) {
  SteadyClock clock;
  ENAMEL_TRY_ASSIGN(const LoadedConfig config, load_config(scan.run));
  std::optional<Calibration> calibration;
  if (!scan.rig_path.empty()) {
    ENAMEL_TRY_ASSIGN(calibration, load_calibration(scan.rig_path));
  }
  ENAMEL_TRY_ASSIGN(const OutFolder folder, OutFolder::open(scan.run.out));
  ENAMEL_TRY(keep_recording(scan, folder));
  folder.clear_results();
  if (scan.resume && !calibration) {
    ENAMEL_TRY_ASSIGN(calibration, recorded_calibration(scan.run.out));
  }
  ENAMEL_TRY_ASSIGN(const auto link, dds::participant_options(scan.link, dds::LinkEnd::kHost));
  ENAMEL_TRY_ASSIGN(const auto participant, dds::Participant::create(link));
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
