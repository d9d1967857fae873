// enamel-flash flash: new firmware onto one probe or many.
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/flash/command.hpp"
#include "host/flash/event_log.hpp"
#include "host/flash/progress_lines.hpp"
#include "host/update/batch.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/image/version_text.hpp"

namespace enamel::flash_app {
namespace {

using update::Exit;
using update::HostError;

struct Options {
  std::string file, json_log;
  Choice choice;
  std::size_t jobs = 4;
  int wait_s = 30;
  bool allow_same = false, allow_older = false, dry_run = false, resume = true;
};

nlohmann::json describe(const update::BatchEntry& e) {
  nlohmann::json j = {{"port", e.probe.port}, {"serial", e.probe.serial}};
  if (!e.result) {
    j.update(to_json(e.result.error()));
    return j;
  }
  j["before"] = image::to_text(e.result->before);
  j["after"] = image::to_text(e.result->written ? e.result->after : e.result->before);
  j["written"] = e.result->written;
  j["exit_code"] = 0;
  return j;
}

void print(const update::BatchEntry& e, bool dry_run) {
  const std::string name = e.probe.serial.empty() ? e.probe.port : e.probe.serial;
  if (!e.result) {
    std::printf("%s: not updated\n", name.c_str());
    report(e.result.error(), false);
    return;
  }
  const std::string before = image::to_text(e.result->before), after = image::to_text(e.result->after);
  if (e.result->written) {
    std::printf("%s: %s -> %s, confirmed\n", name.c_str(), before.c_str(), after.c_str());
  } else if (dry_run) {
    std::printf("%s: %s -> %s would be accepted; nothing was written\n", name.c_str(), before.c_str(), after.c_str());
  } else {
    std::printf("%s: runs %s already; --allow-same writes it again\n", name.c_str(), before.c_str());
  }
}

/// What goes on, to the person and to the log.
update::BatchObserver observe(ProgressLines& lines, EventLog& log) {
  return {
      .progress = [&](const update::PortInfo& p, const update::FlashProgress& progress) { lines.tell(p, progress); },
      .event =
          [&](const update::PortInfo& p, const update::FlashEvent& e) {
            log.write(p, e);
            if (e.event != update::kSlowPort) return;
            const update::UpdateError slow = update::make_error(HostError::kSlowPort, p.serial + ", " + e.status);
            lines.note("note: " + slow.what + "\n  likely cause: " + slow.cause + "\n  what to do: " + slow.remedy);
          }};
}

Exit run(const Options& o) {
  const auto file = open_image_file(o.file);
  if (!file) return report(file.error(), o.choice.json);
  const auto bus = update::open_usb_bus();
  if (!bus) return report(update::make_error(HostError::kNoUsb), o.choice.json);
  const auto probes = choose(*bus, o.choice);
  if (!probes) return report(probes.error(), o.choice.json);
  auto log = EventLog::open(o.json_log);
  if (!log) return report(log.error(), o.choice.json);

  const update::BatchRequest request{.each = {.image = std::span(file->bytes).first(file->manifest.image_len()),
                                              .manifest = file->manifest,
                                              .allow_same = o.allow_same,
                                              .allow_older = o.allow_older,
                                              .dry_run = o.dry_run,
                                              .return_deadline = std::chrono::seconds(o.wait_s)},
                                     .jobs = o.jobs};
  SteadyClock clock;
  ProgressLines lines(*probes);
  const auto entries = update::flash_all(*bus, clock, *probes, request, observe(lines, *log), interrupted());
  Exit exit = Exit::kOk;
  nlohmann::json all = nlohmann::json::array();
  for (const update::BatchEntry& e : entries) {
    if (!e.result && exit == Exit::kOk) exit = e.result.error().exit;
    all.push_back(describe(e));
    if (!o.choice.json) print(e, o.dry_run);
  }
  if (o.choice.json) std::printf("%s\n", json_text(all, 1).c_str());
  return exit;
}

}  // namespace

Run add_flash(CLI::App& app) {
  auto o = std::make_shared<Options>();
  app.add_option("FILE", o->file, "image (*.enfw)")->required();
  add_choice(app, o->choice);
  app.add_option("--jobs", o->jobs, "probes at a time")->check(CLI::Range(1, 16));
  app.add_flag("--allow-same", o->allow_same, "write a version that runs already");
  app.add_flag("--allow-older", o->allow_older, "accept a lower version; a lower security counter never is");
  app.add_flag("--dry-run", o->dry_run, "all checks, nothing written");
  app.add_option("--json-log", o->json_log, "append what happens as JSON lines; those older than 30 days go");
  app.add_option("--wait", o->wait_s, "s to wait for a probe that is gone")->check(CLI::Range(1, 600));
  app.add_flag("--resume", o->resume,
               "go on where a broken download stopped: always so, the probe keeps what was right");
  return [o] { return run(*o); };
}

}  // namespace enamel::flash_app
