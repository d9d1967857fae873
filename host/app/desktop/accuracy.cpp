// enamel desktop accuracy: trueness and precision of scans of one object, and an artefact's figures.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "host/accuracy/accuracy_report.hpp"
#include "host/app/desktop/subcommand.hpp"
#include "host/compare/deviation_picture.hpp"
#include "host/session/artefact_file.hpp"
#include "protocol/base/file.hpp"

namespace enamel::app {
namespace {

namespace fs = std::filesystem;

struct AccuracyOptions {
  std::vector<std::string> runs;
  std::string reference, artefact, out;
  bool json = false;
};

/// Of a folder that a scan or a replay wrote, its mesh; else the file itself.
Result<std::string> mesh_of(const std::string& run) {
  std::error_code ignored;
  if (!fs::exists(run, ignored)) return fail(ErrorCode::kFileNotFound, run);
  if (!fs::is_directory(run, ignored)) return run;
  std::string mesh = (fs::path(run) / "mesh.ply").string();
  if (fs::exists(mesh, ignored)) return mesh;
  return fail(ErrorCode::kFileNotFound, mesh + ": " + run + " is no folder that a scan or a replay wrote");
}

bool says_simulated(const std::string& run) {
  const auto text = read_file((fs::path(run) / "report.json").string());
  if (!text) return false;  // a bare mesh says nothing
  const auto report = nlohmann::json::parse(*text, nullptr, false);
  return report.is_object() && report.contains("simulated") && report["simulated"] == true;
}

Result<std::vector<host::AccuracyRun>> read_runs(const std::vector<std::string>& paths) {
  std::vector<host::AccuracyRun> out;
  std::set<std::string> known;
  for (const std::string& path : paths) {
    ENAMEL_TRY_ASSIGN(const std::string mesh, mesh_of(path));
    std::error_code ignored;
    if (!known.insert(fs::weakly_canonical(mesh, ignored).string()).second)
      return fail(ErrorCode::kUsage, path + " is given twice: it agrees with itself, which says nothing of precision");
    ENAMEL_TRY_ASSIGN(host::MeshFile file, host::read_measured_mesh(mesh));
    out.push_back({path, std::move(file)});
  }
  return out;
}

Result<void> check_enough(const AccuracyOptions& o) {
  if (o.runs.size() > 1 || !o.reference.empty() || !o.artefact.empty()) return {};
  return fail(ErrorCode::kEmptyInput,
              "precision needs two runs, trueness --reference or --artefact, and there is one run and neither");
}

/// The first run as `enamel compare` shows it, where trueness() has laid it.
Result<void> write_picture(const AccuracyOptions& o, const host::MeshFile& run, const host::MeshFile& reference,
                           const Pose& T_reference_run) {
  if (o.out.empty()) return {};
  const host::CompareInput input{
      .alignment = host::Alignment::kBest, .mesh_origin_mm = run.origin_mm, .best_T_reference_mesh = &T_reference_run};
  ENAMEL_TRY_ASSIGN(const auto result, host::compare(run.mesh, {&reference, 1}, input));
  return host::write_deviation(o.out, run, result);
}

Result<int> run_accuracy(const AccuracyOptions& o) {
  ENAMEL_TRY(check_enough(o));
  host::AccuracyReport report;
  report.runs = o.runs;
  if (!o.artefact.empty()) {
    ENAMEL_TRY_ASSIGN(report.artefact, host::load_artefact(o.artefact));
  }
  ENAMEL_TRY_ASSIGN(const std::vector<host::AccuracyRun> runs, read_runs(o.runs));
  for (const std::string& run : o.runs) report.simulated = report.simulated || says_simulated(run);
  if (!o.reference.empty()) {
    ENAMEL_TRY_ASSIGN(const host::MeshFile reference, host::read_measured_mesh(o.reference));
    ENAMEL_TRY_ASSIGN(report.trueness, host::trueness(runs, reference));
    ENAMEL_TRY(write_picture(o, runs.front().file, reference, report.trueness.front().T_reference_run));
    report.reference = o.reference;
  }
  if (!o.artefact.empty()) {
    for (const host::AccuracyRun& run : runs) {
      ENAMEL_TRY_ASSIGN(report.artefact_runs.emplace_back(), host::artefact_figures(run, report.artefact));
    }
  }
  ENAMEL_TRY_ASSIGN(report.precision, host::precision(runs));
  const std::string json = host::accuracy_json(report);
  if (!o.out.empty()) {
    ENAMEL_TRY(make_folder(o.out));
    ENAMEL_TRY(write_file(o.out + "/accuracy.json", json));
  }
  std::fputs((o.json ? json + "\n" : host::accuracy_text(report)).c_str(), stdout);
  return 0;
}

}  // namespace

DesktopCommand add_desktop_accuracy(CLI::App& app) {
  CLI::App* sub = app.add_subcommand("accuracy", "trueness and precision of scans of one object");
  auto o = std::make_shared<AccuracyOptions>();
  sub->add_option("RUN", o->runs, "folders that scans or replays of one object wrote, or their meshes")->required();
  sub->add_option("--reference", o->reference, "the object's surface: PLY, STL or OBJ, mm; for trueness");
  sub->add_option("--artefact", o->artefact, "certificate of the balls scanned: artefact.json");
  sub->add_option("--out", o->out, "folder for accuracy.json and a picture of the first run's deviations");
  sub->add_flag("--json", o->json, "one JSON object on stdout");
  return {sub, [o] { return run_accuracy(*o); }};
}

}  // namespace enamel::app
