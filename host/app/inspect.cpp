// enamel inspect: what is wrong with a finished scan, in the nine classes of docs/defects.md.
#include "host/defects/inspect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/app/command.hpp"
#include "host/defects/defect_picture.hpp"
#include "host/defects/report_defects.hpp"
#include "host/mesh_files/mesh_file.hpp"
#include "protocol/base/file.hpp"

namespace enamel::app {

namespace {

namespace fs = std::filesystem;

struct InspectOptions {
  std::string scan, marks, picture;
  bool json = false, gate = false;
};

/// What only the run itself could see stands in its report.
Result<std::vector<host::Defect>> seen_by_run(const std::string& folder) {
  const std::string path = (fs::path(folder) / "report.json").string();
  std::error_code ec;
  if (!fs::exists(path, ec)) return std::vector<host::Defect>{};
  ENAMEL_TRY_ASSIGN(const std::string text, read_file(path));
  return host::surveyed_defects(text);
}

Result<int> run_inspect(const InspectOptions& o) {
  std::error_code ec;
  const bool is_folder = fs::is_directory(o.scan, ec);
  const std::string mesh_path = is_folder ? (fs::path(o.scan) / "mesh.ply").string() : o.scan;
  ENAMEL_TRY_ASSIGN(host::MeshFile file, host::read_measured_mesh(mesh_path));
  if (!file.origin_mm.isZero(0)) return fail(ErrorCode::kMeshInvalid, o.scan + ": lies too far from the origin");
  if (file.mesh.normals.empty()) host::add_normals(file.mesh);
  host::Marks marks;
  if (!o.marks.empty()) {
    ENAMEL_TRY_ASSIGN(marks, host::load_marks(o.marks));
  }
  std::vector<host::Defect> defects;
  if (is_folder) {
    ENAMEL_TRY_ASSIGN(defects, seen_by_run(o.scan));
  }
  const auto by_shape = host::inspect({file.mesh, nullptr, &marks});
  defects.insert(defects.end(), by_shape.begin(), by_shape.end());
  std::ranges::stable_sort(defects, {}, &host::Defect::kind);
  if (!o.picture.empty()) {
    const auto png = host::defects_png(file.mesh, defects);
    ENAMEL_TRY(write_file(o.picture, {reinterpret_cast<const char*>(png.data()), png.size()}));
  }
  if (o.json) {
    std::puts(host::defects_json(defects).c_str());
  } else if (defects.empty()) {
    std::puts("nothing is wrong that can be told");
  } else {
    for (const host::Defect& d : defects) std::puts(host::defect_line(d).c_str());
  }
  if (!o.gate || defects.empty()) return 0;
  return fail(ErrorCode::kQualityGate, o.scan + ": " + host::defects_summary(defects));
}

}  // namespace

Run add_inspect(CLI::App& app) {
  auto o = std::make_shared<InspectOptions>();
  app.add_option("SCAN", o->scan, "folder of a finished scan, or a mesh: PLY, STL, OBJ, mm")->required();
  app.add_option("--marks", o->marks, "scan bodies and prepared teeth to check (JSON; docs/defects.md)");
  app.add_option("--picture", o->picture, "PNG: the surface, each place ringed");
  app.add_flag("--gate", o->gate, "exit 6 when anything is told");
  app.add_flag("--json", o->json, "one JSON list on stdout");
  return [o]() -> Result<int> { return run_inspect(*o); };
}

}  // namespace enamel::app
