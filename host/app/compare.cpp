// enamel compare: deviation of a mesh from a reference.
#include "host/compare/compare.hpp"

#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/app/command.hpp"
#include "host/compare/deviation_picture.hpp"
#include "host/compare/doubts.hpp"
#include "host/mesh_files/mesh_file.hpp"
#include "host/mesh_files/poses_csv.hpp"
#include "protocol/base/file.hpp"

namespace enamel::app {

namespace {

struct CompareOptions {
  std::string mesh;
  std::vector<std::string> references;
  std::string align = "none";
  std::string poses, truth_poses;
  std::string out;
  double max_mean_um = 0, min_coverage_pct = 0;
  bool json = false;
};

void print_result(const host::CompareResult& r) {
  std::printf("mean absolute  %8.2f um\nmedian signed  %8.2f um\nrms            %8.2f um\n", r.mean_abs_um, r.median_um,
              r.rms_um);
  std::printf("95 %%           %8.2f um\n99 %%           %8.2f um\nlargest        %8.2f um\n", r.p95_um, r.p99_um,
              r.max_um);
  std::printf("coverage       %8.2f %%\nbeyond border  %8.2f %%\n", r.coverage_pct, r.beyond_border_pct);
  std::printf("foreign        %8.3f %%\n", r.foreign_pct);
  if (!r.end) return;
  std::printf("end of scan    %8.2f um, %.4f deg\n", r.end->end_error_um, r.end->end_rotation_deg);
  if (r.end->scale_ppm) std::printf("scale          %8.1f ppm\n", *r.end->scale_ppm);
}

Result<void> write_pictures(const CompareOptions& o, const host::MeshFile& file, const host::CompareResult& result,
                            const std::string& json) {
  if (o.out.empty()) return {};
  ENAMEL_TRY(host::write_deviation(o.out, file, result));
  return write_file(o.out + "/compare.json", json);
}

// A gate is not passed by figures that mean nothing.
int verdict(const CompareOptions& o, const host::CompareResult& result, const host::Doubts& doubts) {
  const bool gate = o.max_mean_um > 0 || o.min_coverage_pct > 0;
  const bool missed = (gate && doubts.unit) || (o.max_mean_um > 0 && !(result.mean_abs_um <= o.max_mean_um)) ||
                      (o.min_coverage_pct > 0 && !(result.coverage_pct >= o.min_coverage_pct));
  if (!missed) return 0;
  std::fputs((Error{ErrorCode::kQualityGate, o.mesh}.message() + "\n").c_str(), stderr);
  return exit_code(ErrorCode::kQualityGate);
}

Result<int> run_compare(const CompareOptions& o) {
  static const std::map<std::string, host::Alignment> kAlignments{
      {"none", host::Alignment::kNone}, {"best", host::Alignment::kBest}, {"start", host::Alignment::kStart}};
  host::CompareInput input{.alignment = kAlignments.at(o.align)};
  std::optional<std::vector<host::PoseRow>> estimate, truth;
  if (input.alignment == host::Alignment::kStart) {
    if (o.poses.empty() || o.truth_poses.empty()) {
      return fail(ErrorCode::kUsage, "--align start needs --poses EST.csv and --truth-poses TRUTH.csv");
    }
    ENAMEL_TRY_ASSIGN(estimate, host::read_poses_csv(o.poses));
    ENAMEL_TRY_ASSIGN(truth, host::read_poses_csv(o.truth_poses));
    input.estimate_poses = &*estimate;
    input.truth_poses = &*truth;
  }
  ENAMEL_TRY_ASSIGN(const host::MeshFile mesh, host::read_measured_mesh(o.mesh));
  std::vector<host::MeshFile> references;
  for (const std::string& path : o.references) {
    ENAMEL_TRY_ASSIGN(references.emplace_back(), host::read_measured_mesh(path));
  }
  input.mesh_origin_mm = mesh.origin_mm;
  ENAMEL_TRY_ASSIGN(const auto result, host::compare(mesh.mesh, references, input));
  std::vector<std::string> names{o.mesh};
  names.insert(names.end(), o.references.begin(), o.references.end());
  const host::Doubts doubts = host::doubts_of(mesh, references, names, result);
  for (const std::string& words : doubts.words) std::fprintf(stderr, "warning: %s\n", words.c_str());
  const std::string json = host::compare_json(result, doubts);
  ENAMEL_TRY(write_pictures(o, mesh, result, json));
  o.json ? static_cast<void>(std::puts(json.c_str())) : print_result(result);
  return verdict(o, result, doubts);
}

}  // namespace

Run add_compare(CLI::App& app) {
  auto o = std::make_shared<CompareOptions>();
  app.add_option("MESH", o->mesh, "measured mesh: PLY, STL or OBJ, mm")->required();
  app.add_option("REFERENCE", o->references, "reference meshes; several are one surface")->required();
  app.add_option("--align", o->align, "none: same frame; best: least squares; start: by the first common pose")
      ->check(CLI::IsMember({"none", "best", "start"}))
      ->capture_default_str();
  app.add_option("--poses", o->poses, "poses.csv of the scan");
  app.add_option("--truth-poses", o->truth_poses, "poses.csv of the truth");
  app.add_option("--out", o->out, "folder for deviation.png, deviation.ply and compare.json");
  app.add_option("--max-mean-um", o->max_mean_um, "exit 6 when the mean absolute deviation is larger");
  app.add_option("--min-coverage-pct", o->min_coverage_pct, "exit 6 when the coverage is smaller");
  app.add_flag("--json", o->json, "one JSON object on stdout");
  return [o]() -> Result<int> { return run_compare(*o); };
}

}  // namespace enamel::app
