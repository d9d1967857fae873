// enamel capture import|export|info|verify|cut|repair|diff: work on recordings.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "host/app/command.hpp"
#include "host/record/axes_readings.hpp"
#include "host/record/burst_stream.hpp"
#include "host/record/capture_tools.hpp"
#include "host/record/exchange_folder.hpp"
#include "host/report/stage_trace.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"

namespace enamel::app {

namespace {

namespace fs = std::filesystem;

struct CaptureCommand {
  std::string left, right;
  std::uint64_t first = 0, last = 0;
  bool json = false;
  bool force = false;
};

constexpr int kDiffer = 6;

void say(const CaptureCommand& o, const nlohmann::json& machine, const std::string& human) {
  std::puts(o.json ? json_text(machine).c_str() : human.c_str());
}

/// What is there already is not written over: it may be the only copy of a patient's scan.
Result<void> free_place(const CaptureCommand& o) {
  std::error_code ec;
  if (fs::equivalent(o.left, o.right, ec)) {
    return fail(ErrorCode::kFileWrite, o.right + ": is what is read from");
  }
  if (o.force || !fs::exists(o.right, ec) || !fs::is_regular_file(o.right, ec)) return {};
  return fail(ErrorCode::kFileWrite, o.right + ": is there already; choose another name, or --force to replace it");
}

/// Tells what is missing from a copy; exit code of a copy that is not whole.
int tell(const CaptureCommand& o, std::uint64_t bursts, std::uint64_t missing,
         const std::vector<std::string>& problems) {
  std::string human = std::to_string(bursts) + " bursts -> " + o.right;
  if (missing > 0) human += "; " + std::to_string(missing) + " missing";
  for (const std::string& problem : problems) human += "\n" + problem;
  say(o, {{"bursts", bursts}, {"missing", missing}, {"problems", problems}}, human);
  return missing > 0 ? exit_code(ErrorCode::kDataLoss) : 0;
}

Result<int> import_capture(const CaptureCommand& o) {
  ENAMEL_TRY(free_place(o));
  ENAMEL_TRY_ASSIGN(const auto done, host::import_folder(o.left, o.right, "enamel " ENAMEL_VERSION));
  say(o, {{"bursts", done.bursts}, {"attachments", done.attachments}},
      std::to_string(done.bursts) + " bursts and " + std::to_string(done.attachments) + " attachments -> " + o.right);
  return 0;
}

Result<int> export_capture(const CaptureCommand& o) {
  ENAMEL_TRY_ASSIGN(const auto done, host::export_folder(o.left, o.right));
  return tell(o, done.bursts, done.missing, done.problems);
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
  const std::uint64_t axes = host::count_axes(*stream);
  if (axes > 0) human += "\nangles       " + std::to_string(axes);
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
       {"axes", axes},
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
  ENAMEL_TRY(free_place(o));
  ENAMEL_TRY_ASSIGN(const auto done, host::capture_cut(o.left, o.right, o.first, o.last));
  return tell(o, done.bursts, done.missing, done.problems);
}

Result<int> repair(const CaptureCommand& o) {
  ENAMEL_TRY(free_place(o));
  ENAMEL_TRY_ASSIGN(const auto done, host::capture_repair(o.left, o.right));
  return tell(o, done.bursts, done.missing, done.problems);
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
  const auto may_replace = [o](CLI::App* sub) { sub->add_flag("--force", o->force, "replace OUT if it is there"); };
  CLI::App* sub = verb("import", "exchange folder -> recording", import_capture);
  sub->add_option("DIR", o->left, "exchange folder")->required();
  sub->add_option("OUT", o->right, "recording to write (.mcap)")->required();
  may_replace(sub);
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
  may_replace(sub);
  sub =
      verb("repair",
           "copy whatever is whole of a damaged recording, wherever the damage lies, and list what is missing", repair);
  sub->add_option("IN", o->left, "recording (.mcap)")->required();
  sub->add_option("OUT", o->right, "recording to write (.mcap)")->required();
  may_replace(sub);
  sub = verb("diff", "first stage and burst at which two runs (folders with stages.csv) or recordings differ", diff);
  sub->add_option("LEFT", o->left, "run folder or recording")->required();
  sub->add_option("RIGHT", o->right, "run folder or recording")->required();
  return [o, chosen]() -> Result<int> { return (*chosen)(*o); };
}

}  // namespace enamel::app
