// enamel scan: live scan of a probe on the network.
#include <memory>

#include "host/app/broken_off.hpp"
#include "host/app/command.hpp"
#include "host/app/link_options.hpp"
#include "host/app/out_folder.hpp"
#include "host/app/scan_run.hpp"
#include "protocol/base/log.hpp"

namespace enamel::app {

Run add_scan(CLI::App& app) {
  auto scan = std::make_shared<ScanRun>();
  add_run_options(app, scan->run);
  app.add_option("--probe", scan->serial, "serial of the probe; needed when there is more than one");
  CLI::Option* const session = app.add_option(
      "--session", scan->run.out,
      "folder for recording and results (default: a new one, out/session-DATE-TIME; out/session links to it)");
  const auto resume = std::make_shared<std::string>();
  CLI::Option* const again =
      app.add_option("--resume", *resume,
                     "go on with the session in this folder: its model is rebuilt from the recording (by itself within"
                     " five minutes, where a crash broke off the scan before this one)")
          ->excludes(session);
  const auto anew = std::make_shared<bool>(false);
  app.add_flag("--new", *anew, "begin another scan even where one was broken off moments ago")->excludes(again);
  app.add_option("--rig", scan->rig_path, "calibration to measure with instead of the probe's own");
  app.add_option("--seconds", scan->seconds, "end after this long")->check(CLI::PositiveNumber);
  app.add_option("--wait-seconds", scan->wait_seconds, "how long to wait for a probe")->capture_default_str();
  add_link_options(app, scan->link);
  app.add_flag("!--no-record", scan->record, "keep no recording");
  return [scan, resume, anew]() -> Result<int> {
    scan->start_at_once = scan->run.headless;
    if (resume->empty() && !*anew && scan->record) {
      if (const auto before = goes_on_with(scan->run.out.empty() ? "out/session" : scan->run.out))
        *resume = before->folder;
    }
    scan->resume = !resume->empty();
    if (scan->resume) scan->run.out = *resume;
    const bool made = scan->run.out.empty();
    if (made) {
      ENAMEL_TRY_ASSIGN(scan->run.out, new_session_folder());
    }
    log::info("scan", "recording and results go to {}", scan->run.out);
    auto code = run_scan(*scan);
    if (made && !code) drop_if_empty(scan->run.out);
    return code;
  };
}

}  // namespace enamel::app
