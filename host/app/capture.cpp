// enamel capture import|export|info|verify|cut|diff: work on recordings.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "host/app/command.hpp"
#include "host/record/burst_stream.hpp"
#include "host/record/capture_tools.hpp"
#include "host/record/exchange_folder.hpp"
#include "host/report/stage_trace.hpp"
#include "protocol/base/file.hpp"

namespace enamel::app {

namespace {

namespace fs = std::filesystem;

struct CaptureCommand {
  std::string left, right;
  std::uint64_t first = 0, last = 0;
  bool json = false;
};

constexpr int kDiffer = 6;

void say(const CaptureCommand& o, const nlohmann::json& machine, const std::string& human) {
  std::puts(o.json ? machine.dump(1).c_str() : human.c_str());
}

Result<int> import_capture(const CaptureCommand& o) {
  ENAMEL_TRY_ASSIGN(const auto done, host::import_folder(o.left, o.right, "enamel " ENAMEL_VERSION));
  say(o, {{"bursts", done.bursts}, {"attachments", done.attachments}},
      std::to_string(done.bursts) + " bursts and " + std::to_string(done.attachments) + " attachments -> " + o.right);
  return 0;
}

Result<int> export_capture(const CaptureCommand& o) {
  ENAMEL_TRY_ASSIGN(const auto done, host::export_folder(o.left, o.right));
  say(o, {{"bursts", done.bursts}, {"attachments", done.attachments}},
      std::to_string(done.bursts) + " bursts and " + std::to_string(done.attachments) + " attachments -> " + o.right);
  return 0;
}

Result<int> info(const CaptureCommand& o) {
  ENAMEL_TRY_ASSIGN(const auto stream, host::open_bursts(o.left));
  const capture::CaptureInfo& i = stream->info();
  nlohmann::json attachments = nlohmann::json::array();
  std::string human = "bursts       " + std::to_string(i.bursts) + "\nshed         " + std::to_string(i.shed) +
                      "\nseconds      " + std::to_string(static_cast<double>(i.duration_ns()) * 1e-9) +
                      "\nbytes        " + std::to_string(i.file_bytes) + "\ntruncated    " +
                      (i.truncated ? "yes" : "no") + "\nprogram      " + i.program + "\ncalibration  " +
                      (stream->rig_text().empty() ? "none" : "rig.json");
  nlohmann::json metadata = nlohmann::json::object();
  for (const auto& [key, value] : i.metadata) {
    metadata[key] = value;
    human += "\n" + key + ": " + value.substr(0, value.find('\n'));
  }
  for (const auto& a : i.attachments) {
    attachments.push_back({{"name", a.name}, {"bytes", a.size}});
    human += "\nattachment   " + a.name + " (" + std::to_string(a.size) + " bytes)";
  }
  say(o,
      {{"bursts", i.bursts},
       {"shed", i.shed},
       {"statuses", i.statuses},
       {"events", i.events},
       {"duration_ns", i.duration_ns()},
       {"file_bytes", i.file_bytes},
       {"truncated", i.truncated},
       {"program", i.program},
       {"rig", !stream->rig_text().empty()},
       {"metadata", metadata},
       {"attachments", attachments}},
      human);
  return 0;
}

Result<int> verify(const CaptureCommand& o) {
  ENAMEL_TRY_ASSIGN(const auto report, host::capture_verify(o.left));
  std::string human = std::to_string(report.bursts) + " bursts, " + std::to_string(report.records) + " records";
  if (report.truncated) human += "; " + std::string(describe(ErrorCode::kCaptureTruncated).remedy);
  for (const std::string& problem : report.problems) human += "\n" + problem;
  human += report.clean() ? "\nclean" : "\nnot clean";
  say(o,
      {{"bursts", report.bursts},
       {"records", report.records},
       {"truncated", report.truncated},
       {"problems", report.problems},
       {"clean", report.clean()}},
      human);
  return report.clean() ? 0 : exit_code(ErrorCode::kCaptureCorrupt);
}

Result<int> cut(const CaptureCommand& o) {
  ENAMEL_TRY_ASSIGN(const std::uint64_t bursts, host::capture_cut(o.left, o.right, o.first, o.last));
  say(o, {{"bursts", bursts}}, std::to_string(bursts) + " bursts -> " + o.right);
  return 0;
}

Result<host::StageTrace> load_trace(const fs::path& folder) {
  const std::string path = (folder / "stages.csv").string();
  ENAMEL_TRY_ASSIGN(const std::string text, read_file(path));
  return host::StageTrace::from_csv(text, path);
}

Result<int> diff_runs(const CaptureCommand& o) {
  ENAMEL_TRY_ASSIGN(const auto left, load_trace(o.left));
  ENAMEL_TRY_ASSIGN(const auto right, load_trace(o.right));
  const auto d = host::first_difference(left, right);
  if (!d) {
    say(o, {{"equal", true}}, "equal in " + std::to_string(left.rows().size()) + " bursts, every stage");
    return 0;
  }
  say(o, {{"equal", false}, {"burst", d->burst_id}, {"stage", d->stage}},
      "first difference: burst " + std::to_string(d->burst_id) + ", stage " + d->stage);
  return kDiffer;
}

Result<int> diff(const CaptureCommand& o) {
  if (fs::exists(fs::path(o.left) / "stages.csv") && fs::exists(fs::path(o.right) / "stages.csv")) return diff_runs(o);
  ENAMEL_TRY_ASSIGN(const auto d, host::capture_diff(o.left, o.right));
  if (!d) {
    say(o, {{"equal", true}}, "equal");
    return 0;
  }
  say(o,
      {{"equal", false},
       {"stage", "input"},
       {"burst", d->burst_index},
       {"field", d->field},
       {"left", d->left},
       {"right", d->right}},
      "first difference: burst " + std::to_string(d->burst_index) + ", stage input, " + d->field + ": " + d->left +
          " against " + d->right);
  return kDiffer;
}

}  // namespace

Run add_capture(CLI::App& app) {
  auto o = std::make_shared<CaptureCommand>();
  auto chosen = std::make_shared<Result<int> (*)(const CaptureCommand&)>(nullptr);
  app.require_subcommand(1);
  const auto verb = [&](const char* name, const char* what, Result<int> (*run)(const CaptureCommand&)) {
    CLI::App* sub = app.add_subcommand(name, what);
    sub->add_flag("--json", o->json, "machine-readable result on stdout");
    sub->callback([chosen, run] { *chosen = run; });
    return sub;
  };
  CLI::App* sub = verb("import", "exchange folder -> recording", import_capture);
  sub->add_option("DIR", o->left, "exchange folder")->required();
  sub->add_option("OUT", o->right, "recording to write (.mcap)")->required();
  sub = verb("export", "recording -> exchange folder", export_capture);
  sub->add_option("IN", o->left, "recording (.mcap)")->required();
  sub->add_option("DIR", o->right, "folder to write")->required();
  verb("info", "what a recording holds", info)->add_option("IN", o->left, "recording or exchange folder")->required();
  verb("verify", "read everything once and check every sum", verify)
      ->add_option("IN", o->left, "recording")
      ->required();
  sub = verb("cut", "copy a range of bursts; makes a clean file of a truncated one", cut);
  sub->add_option("IN", o->left, "recording (.mcap)")->required();
  sub->add_option("OUT", o->right, "recording to write (.mcap)")->required();
  o->last = UINT64_MAX;
  sub->add_option("--first", o->first, "first burst, by its number")->capture_default_str();
  sub->add_option("--last", o->last, "last burst (default: the end)");
  sub = verb("diff", "first stage and burst at which two runs (folders with stages.csv) or recordings differ", diff);
  sub->add_option("LEFT", o->left, "run folder or recording")->required();
  sub->add_option("RIGHT", o->right, "run folder or recording")->required();
  return [o, chosen]() -> Result<int> { return (*chosen)(*o); };
}

}  // namespace enamel::app
