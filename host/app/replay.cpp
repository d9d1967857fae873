// enamel replay: lossless, deterministic reprocessing of a recording or exchange folder; --paced plays it at its
// recorded speed with the live rules.
#include <memory>
#include <string>

#include "host/app/calibration.hpp"
#include "host/app/command.hpp"
#include "host/app/desktop/desktop_options.hpp"
#include "host/app/input.hpp"
#include "host/app/out_folder.hpp"
#include "host/app/run_session.hpp"
#include "host/record/burst_stream.hpp"
#include "host/session/replay_session.hpp"
#include "protocol/base/file.hpp"

namespace enamel::app {

namespace {

struct Options {
  RunOptions run;
  std::string input;
  std::string rig;
  DesktopOptions desktop;
  bool paced = false;
  bool view = false;
};

void tell(const Error& error) { std::fputs((error.message() + "\n").c_str(), stderr); }

Result<int> run_replay(const Options& o) {
  SteadyClock clock;
  ENAMEL_TRY_ASSIGN(const LoadedConfig config, load_config(o.run));
  ENAMEL_TRY_ASSIGN(auto stream, host::open_bursts(o.input));
  if (stream->info().truncated) tell({ErrorCode::kCaptureTruncated, o.input});
  if (stream->info().bursts == 0) return fail(ErrorCode::kEmptyInput, o.input);
  ENAMEL_TRY_ASSIGN(const Calibration calibration, calibration_for(o.rig, *stream, o.input));
  ENAMEL_TRY_ASSIGN(const calib::Rig rig, rig_to_measure(calibration, *stream));
  ENAMEL_TRY_ASSIGN(const OutFolder folder, OutFolder::open(o.run.out));
  folder.clear_results();
  const host::ReplayConfig replay{.pipeline = config.pipeline,
                                  .workers = o.run.workers,
                                  .paced = o.paced,
                                  .preview_model = o.view && !o.run.headless,
                                  .calib_crc32 = o.rig.empty() ? rig.crc32 : 0};
  const SessionRun run{
      .run = o.run,
      .title = "enamel replay",
      .doing = "replay",
      .total = stream->info().bursts,
      .window = o.view && !o.run.headless,
      .calibration = calibration,
      .limits = config.calibration,
      .config_text = config.text,
      .truth = {attached_text(*stream, "truth/surface.ply"), attached_text(*stream, "truth/poses.csv")},
      .notes = {{"source", o.input},
                {"pace", o.paced ? "recorded speed, live shedding rules" : "lossless, as fast as possible"}}};
  ENAMEL_TRY_ASSIGN(const auto by_stops,
                    recorded_desktop({*stream, rig, replay.calib_crc32, config, o.desktop, o.run}, clock));
  if (by_stops) return run_session(*by_stops, run, clock);
  ENAMEL_TRY_ASSIGN(const auto session, host::ReplaySession::create(std::move(stream), rig, replay, clock));
  return run_session(*session, run, clock);
}

}  // namespace

Run add_replay(CLI::App& app) {
  auto o = std::make_shared<Options>();
  add_run_options(app, o->run);
  app.add_option("CAPTURE", o->input, "recording, exchange folder or session folder")->required();
  app.add_option("--out", o->run.out, "folder for the results")->required();
  app.add_option("--rig", o->rig, "another calibration than the recorded one");
  app.add_flag("--paced", o->paced, "at recorded speed, shedding as live");
  add_desktop_options(app, o->desktop);
  app.add_flag("--free-hand", o->desktop.free_hand, "do not look at the angles of a desktop scanner's axes");
  app.add_flag("--view", o->view, "show it in a window");
  return [o]() -> Result<int> { return run_replay(*o); };
}

}  // namespace enamel::app
