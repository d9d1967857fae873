// enamel replay: lossless, deterministic reprocessing of a recording or exchange folder; --paced plays it at its
// recorded speed with the live rules.
#include <filesystem>
#include <memory>
#include <string>

#include "host/app/calibration.hpp"
#include "host/app/command.hpp"
#include "host/app/input.hpp"
#include "host/app/run_options.hpp"
#include "host/app/screen.hpp"
#include "host/record/burst_stream.hpp"
#include "host/record/calibration_attachment.hpp"
#include "host/session/replay_session.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/progress.hpp"

namespace enamel::app {

namespace {

namespace fs = std::filesystem;

struct Options {
  RunOptions run;
  std::string input;
  std::string rig;
  bool paced = false;
  bool view = false;
};

// A session folder stands for the recording in it.
std::string resolved_input(const std::string& input) {
  std::error_code ec;
  const fs::path inside = fs::path(input) / "capture.mcap";
  return fs::is_regular_file(inside, ec) ? inside.string() : input;
}

/// When a live recording began, UTC; empty for one that does not say.
std::string recorded_at(const capture::CaptureInfo& info) {
  for (const auto& [key, value] : info.metadata)
    if (key == host::kRecordedAt) return value;
  return {};
}

void tell(const Error& error) { std::fputs((error.message() + "\n").c_str(), stderr); }

void watch(host::ReplaySession& session, Screen& screen, const calib::Rig& rig, std::uint64_t total, Clock& clock) {
  screen.set_field(rig);
  Progress progress(clock, "replay", total);
  while (!session.ended()) {
    const host::ReplayView live = session.view();
    const Screen::State state{.scan = view::ScanState::kScanning,
                              .counters = {live.captured, live.fused, live.rejected, live.shed, live.damaged, 0},
                              .message = {},
                              .simulated = session.simulated()};
    const auto commands = screen.refresh(state, session.preview().take().value_or(nullptr));
    if (commands.quit || stop_requested()) session.stop();
    if (!screen.has_window()) clock.sleep_for(std::chrono::milliseconds(20));
    progress.update(live.fused + live.rejected);
  }
}

Result<int> run_replay(const Options& o) {
  SteadyClock clock;
  ENAMEL_TRY_ASSIGN(const LoadedConfig config, load_config(o.run));
  ENAMEL_TRY_ASSIGN(auto stream, host::open_bursts(resolved_input(o.input)));
  if (stream->info().truncated) tell({ErrorCode::kCaptureTruncated, o.input});
  if (stream->info().bursts == 0) return fail(ErrorCode::kEmptyInput, o.input);
  ENAMEL_TRY_ASSIGN(const Calibration calibration, calibration_for(o.rig, *stream, o.input));
  ENAMEL_TRY_ASSIGN(const calib::Rig rig, rig_to_measure(calibration, *stream));
  const auto recorded_rig = calib::parse_rig(stream->rig_text());
  const std::string device_serial = recorded_rig ? recorded_rig->serial : std::string();
  const std::string recorded = recorded_at(stream->info());
  ENAMEL_TRY(make_folder(o.run.out));
  const Truth truth{attached_text(*stream, "truth/surface.ply"), attached_text(*stream, "truth/poses.csv")};
  const std::uint64_t total = stream->info().bursts;
  const std::uint32_t wanted_crc = o.rig.empty() ? rig.crc32 : 0;
  const host::ReplayConfig replay{.pipeline = config.pipeline,
                                  .workers = o.run.workers,
                                  .paced = o.paced,
                                  .preview_model = o.view && !o.run.headless,
                                  .calib_crc32 = wanted_crc};
  ENAMEL_TRY_ASSIGN(const auto session, host::ReplaySession::create(std::move(stream), rig, replay, clock));
  Screen screen("enamel replay", clock);
  if (o.view && !o.run.headless) ENAMEL_TRY(screen.open_window());
  install_stop_signals();
  session->start();
  watch(*session, screen, rig, total, clock);
  ENAMEL_TRY_ASSIGN(const auto outcome, session->finish());

  host::Report report;
  report.bursts = outcome.counts;
  report.orders = outcome.scan.orders;
  report.simulated = session->simulated();
  report.config_toml = config.text;
  report.calibration_json =
      calibration_json(calibration, {device_serial, recorded, outcome.scan.temp_c}, config.calibration);
  report.notes["source"] = o.input;
  report.notes["pace"] = o.paced ? "recorded speed, live shedding rules" : "lossless, as fast as possible";
  Screen::State state{.scan = view::ScanState::kFinished,
                      .counters = {outcome.counts.captured, outcome.counts.fused, outcome.counts.rejected_total(),
                                   outcome.counts.shed, outcome.counts.incomplete, outcome.counts.lost_on_wire},
                      .message = {},
                      .simulated = report.simulated};
  const auto drawn = screen.write_picture(state, &outcome.scan.mesh, o.run.out + "/preview.png");
  report.notes["picture"] = drawn ? "drawn by " + *drawn : "none: " + drawn.error().detail;
  ENAMEL_TRY_ASSIGN(report, write_outputs(o.run.out, outcome.scan, std::move(report), truth));
  print_summary(report, o.run.json);
  for (const Error& damage : outcome.damages) tell(damage);
  if (const auto balanced = host::check(report.bursts); !balanced) {
    tell(balanced.error());
    return exit_code(balanced.error().code);
  }
  return 0;
}

}  // namespace

Run add_replay(CLI::App& app) {
  auto o = std::make_shared<Options>();
  add_run_options(app, o->run);
  app.add_option("CAPTURE", o->input, "recording, exchange folder or session folder")->required();
  app.add_option("--out", o->run.out, "folder for the results")->required();
  app.add_option("--rig", o->rig, "another calibration than the recorded one");
  app.add_flag("--paced", o->paced, "at recorded speed, shedding as live");
  app.add_flag("--view", o->view, "show it in a window");
  return [o]() -> Result<int> { return run_replay(*o); };
}

}  // namespace enamel::app
