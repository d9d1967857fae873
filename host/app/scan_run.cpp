#include "host/app/scan_run.hpp"

#include <cstdlib>
#include <memory>
#include <optional>
#include <utility>

#include "host/app/calibration.hpp"
#include "host/app/screen.hpp"
#include "host/session/live_session.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/log.hpp"
#include "protocol/base/progress.hpp"
#include "protocol/base/utc.hpp"

namespace enamel::app {

namespace {

constexpr Nanoseconds kIdle{20'000'000};

view::ScanState scan_state(host::FeedState state) {
  switch (state) {
    case host::FeedState::kWaiting:
      return view::ScanState::kWaitingForProbe;
    case host::FeedState::kScanning:
      return view::ScanState::kScanning;
    case host::FeedState::kPaused:
      return view::ScanState::kPaused;
    case host::FeedState::kLost:
      return view::ScanState::kProbeLost;
    case host::FeedState::kEnded:
      break;
  }
  return view::ScanState::kFinished;
}

Screen::State screen_state(const host::LiveView& live) {
  const host::BurstCounts& c = live.counts;
  return {.scan = scan_state(live.state),
          .counters = {c.captured, c.fused, c.rejected_total(), c.shed, c.incomplete, c.lost_on_wire},
          .message = live.message,
          .simulated = live.simulated};
}

// Frames a second over the last second of fused bursts, for the person at the screen.
class RateMeter {
 public:
  double update(HostTime now, std::uint64_t count) {
    const double elapsed = std::chrono::duration<double>(now - since_).count();
    if (elapsed >= 1.0) {
      rate_ = static_cast<double>(count - counted_) / elapsed;
      since_ = now;
      counted_ = count;
    }
    return rate_;
  }

 private:
  HostTime since_{};
  std::uint64_t counted_ = 0;
  double rate_ = 0;
};

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

// The main thread while the scan runs: screen, keyboard, progress, signals.
Screen::State watch(host::LiveSession& session, Screen& screen, const ScanRun& scan, Clock& clock) {
  RateMeter rate;
  Progress progress(clock, "scanning", 0);
  Screen::State state;
  bool field_known = false;
  std::optional<HostTime> first_burst;
  while (!session.ended()) {
    const host::LiveView live = session.view();
    state = screen_state(live);
    state.rate_hz = rate.update(clock.now(), live.counts.fused);
    if (!field_known && session.rig()) {
      screen.set_field(*session.rig());
      field_known = true;
    }
    std::shared_ptr<const stage::PreviewItem> item;
    if (host::PreviewSlot* slot = session.preview()) item = slot->take().value_or(nullptr);
    const view::UserCommands wish = screen.refresh(state, item);
    if (wish.toggle_scan) session.set_scanning(!session.scanning_wanted());
    if (!screen.has_window()) clock.sleep_for(kIdle);
    if (live.counts.accepted > 0 && !first_burst) first_burst = clock.now();
    const double lasted = first_burst ? std::chrono::duration<double>(clock.now() - *first_burst).count() : 0;
    if (wish.quit || stop_requested() || (scan.seconds > 0 && lasted >= scan.seconds)) session.stop();
    progress.update(live.counts.fused);
  }
  state = screen_state(session.view());
  return state;
}

host::Report first_report(const ScanRun& scan, const host::LiveSession::Outcome& outcome, const LoadedConfig& config,
                          bool simulated) {
  host::Report report;
  report.bursts = outcome.counts;
  report.orders = outcome.scan.orders;
  report.notes = scan.notes;
  report.simulated = simulated;
  report.config_toml = config.text;
  if (outcome.recording_error) report.notes["recording"] = "incomplete: " + outcome.recording_error->detail;
  return report;
}

int told(const Error& error) {
  std::fputs((error.message() + "\n").c_str(), stderr);
  return exit_code(error.code);
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
  Screen screen("enamel", clock);
  if (!scan.run.headless) ENAMEL_TRY(screen.open_window());
  install_stop_signals();
  session->start();
  Screen::State state = watch(*session, screen, scan, clock);
  ENAMEL_TRY_ASSIGN(const auto outcome, session->finish());

  host::Report report = first_report(scan, outcome, config, state.simulated);
  if (const auto rig = session->rig())
    report.calibration_json =
        calibration_json(calibration.value_or(Calibration{*rig, "", "probe"}),
                         {rig->serial, utc_text(wall_time()), outcome.scan.temp_c}, config.calibration);
  state.scan = view::ScanState::kFinished;
  state.counters = {outcome.counts.captured, outcome.counts.fused,      outcome.counts.rejected_total(),
                    outcome.counts.shed,     outcome.counts.incomplete, outcome.counts.lost_on_wire};
  const auto drawn = screen.write_picture(state, &outcome.scan.mesh, scan.run.out + "/preview.png");
  report.notes["picture"] = drawn ? "drawn by " + *drawn : "none: " + drawn.error().detail;
  ENAMEL_TRY_ASSIGN(report, write_outputs(scan.run.out, outcome.scan, std::move(report), scan.truth));
  print_summary(report, scan.run.json);
  if (outcome.feed_error) return told(*outcome.feed_error);
  if (outcome.recording_error) return told(*outcome.recording_error);
  if (const auto balanced = host::check(report.bursts); !balanced) return told(balanced.error());
  return 0;
}

}  // namespace enamel::app
