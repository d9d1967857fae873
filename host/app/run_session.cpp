#include "host/app/run_session.hpp"

#include <cstdio>
#include <memory>
#include <utility>

#include "host/app/screen.hpp"
#include "protocol/base/progress.hpp"

namespace enamel::app {

namespace {

constexpr Nanoseconds kIdle{20'000'000};
constexpr Nanoseconds kFiguresPeriod{500'000'000};  // figures that change faster cannot be read

// Fused bursts a second over the last second, for the person at the screen.
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

// The main thread while the session runs: screen, keyboard, progress, signals.
class Watch {
 public:
  Watch(host::Session& session, Screen& screen, const SessionRun& run, Clock& clock)
      : session_(session), screen_(screen), run_(run), clock_(clock), progress_(clock, run.doing, run.total) {}

  /// Until the session has ended. Returns what was last shown of it.
  PreviewFrame run() {
    while (!session_.ended()) {
      const PreviewFrame now = look();
      obey(screen_.draw(now), now);
      if (const auto shown = screen_.take_shown()) session_.shown(shown->burst, shown->at);
      if (!screen_.has_window()) clock_.sleep_for(kIdle);
      progress_.update(now.counters.fused + now.counters.rejected);
      if (now.state == ScanState::kRefining) tell_refinement(now.refined);
    }
    return look();
  }

 private:
  PreviewFrame look() {
    PreviewFrame now = session_.view();
    now.rate_hz = rate_.update(clock_.now(), now.counters.fused);
    if (clock_.now() >= next_figures_) {
      figures_ = session_.figures();
      next_figures_ = clock_.now() + kFiguresPeriod;
    }
    now.pipeline = figures_;
    if (!knows_field_) {
      if (const auto rig = session_.rig()) {
        screen_.set_field(*rig);
        knows_field_ = true;
      }
    }
    if (host::PreviewSlot* slot = session_.preview()) screen_.add(slot->take().value_or(nullptr));
    return now;
  }

  void obey(const view::UserCommands& wish, const PreviewFrame& now) {
    if (wish.toggle_scan) session_.set_scanning(!session_.scanning_wanted());
    if (now.counters.accepted > 0 && !first_burst_) first_burst_ = clock_.now();
    const double lasted = first_burst_ ? std::chrono::duration<double>(clock_.now() - *first_burst_).count() : 0;
    if (wish.quit || stop_requested() || (run_.seconds > 0 && lasted >= run_.seconds)) session_.stop();
  }

  void tell_refinement(double share) {
    if (!refining_) {
      progress_.finish();
      refining_.emplace(clock_, "refine the model", 100);
    }
    refining_->update(static_cast<std::uint64_t>(100 * share));
  }

  host::Session& session_;
  Screen& screen_;
  const SessionRun& run_;
  Clock& clock_;
  RateMeter rate_;
  Progress progress_;
  std::optional<Progress> refining_;
  std::shared_ptr<const PipelineFigures> figures_;
  HostTime next_figures_{};
  bool knows_field_ = false;
  std::optional<HostTime> first_burst_;
};

/// `last` as it stands when everything has been worked off.
PreviewFrame finished(PreviewFrame last, const host::Outcome& outcome) {
  last.state = ScanState::kFinished;
  last.counters = host::counters_of(outcome.counts);
  last.result = known_line(outcome.scan);
  last.simulated = outcome.simulated;
  last.rate_hz = outcome.scan.seconds > 0 ? static_cast<double>(outcome.scan.fused) / outcome.scan.seconds
                                          : 0;  // of the whole run
  last.pipeline = std::make_shared<const PipelineFigures>(outcome.scan.figures);
  return last;
}

std::string damage_note(const std::vector<Error>& damages) {
  return std::to_string(damages.size()) + " place(s) of the recording are damaged, first: " + damages.front().detail;
}

host::Report report_of(const SessionRun& run, const host::Session& session, const host::Outcome& outcome) {
  host::Report report;
  report.bursts = outcome.counts;
  report.orders = outcome.scan.orders;
  report.sight = outcome.scan.sight;
  report.notes = run.notes;
  report.simulated = outcome.simulated;
  report.config_toml = run.config_text;
  if (!outcome.damages.empty()) report.notes["damaged"] = damage_note(outcome.damages);
  if (outcome.recording_error) report.notes["recording"] = "incomplete: " + outcome.recording_error->detail;
  if (const auto rig = session.rig()) {
    const Calibration used = run.calibration.value_or(Calibration{*rig, "", "probe"});
    report.calibration_json =
        calibration_json(used, {outcome.device_serial, outcome.scanned_at, outcome.scan.temp_c}, run.limits);
  }
  return report;
}

int tell_as_exit_code(const Error& error) {
  std::fputs((error.message() + "\n").c_str(), stderr);
  return exit_code(error.code);
}

/// On stderr, what went wrong on the way; the exit code is that of the first that is more than a damaged record.
int conclude(const host::Outcome& outcome) {
  for (const Error& damage : outcome.damages) tell_as_exit_code(damage);
  if (outcome.broken_off) return tell_as_exit_code(*outcome.broken_off);
  if (outcome.recording_error) return tell_as_exit_code(*outcome.recording_error);
  if (const auto balanced = host::check(outcome.counts); !balanced) return tell_as_exit_code(balanced.error());
  return 0;
}

}  // namespace

Result<int> run_session(host::Session& session, const SessionRun& run, Clock& clock) {
  Screen screen(run.title, clock);
  if (run.window) ENAMEL_TRY(screen.open_window());
  install_stop_signals();
  session.start();
  PreviewFrame last = Watch(session, screen, run, clock).run();
  ENAMEL_TRY_ASSIGN(const auto outcome, session.finish());

  host::Report report = report_of(run, session, outcome);
  last = finished(std::move(last), outcome);
  const auto drawn = screen.write_picture(std::move(last), outcome.scan.mesh, run.run.out + "/preview.png");
  report.notes["picture"] = drawn ? "drawn by " + *drawn : "none: " + drawn.error().detail;
  ENAMEL_TRY_ASSIGN(report, write_outputs(run.run.out, outcome.scan, std::move(report), run.truth));
  print_summary(report, run.run.json);
  return conclude(outcome);
}

}  // namespace enamel::app
