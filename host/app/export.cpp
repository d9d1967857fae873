// enamel export: the mesh of a session in another format, with a JSON sidecar that says where it comes from.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "host/app/command.hpp"
#include "host/mesh_files/mesh_file.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"

namespace enamel::app {

namespace {

namespace fs = std::filesystem;

struct ExportOptions {
  std::string session, format = "stl", out;
};

Result<int> run_export(const ExportOptions& o) {
  ENAMEL_TRY_ASSIGN(const auto file, host::read_mesh((fs::path(o.session) / "mesh.ply").string()));
  if (!file.origin_mm.isZero(0)) {
    return fail(ErrorCode::kMeshInvalid, o.session + ": mesh.ply lies too far from the origin to be of a scan");
  }
  const std::string path = o.out.empty() ? (fs::path(o.session) / ("export." + o.format)).string() : o.out;
  nlohmann::json sidecar = {{"format", o.format},
                            {"units", "mm"},
                            {"frame", "model: camera of the first placed burst, x right, y down, z forward"},
                            {"vertices", file.mesh.vertices.size()},
                            {"triangles", file.mesh.triangles.size()},
                            {"holes_filled", 0}};
  if (const auto text = read_file((fs::path(o.session) / "report.json").string())) {
    const auto report = nlohmann::json::parse(*text, nullptr, /*allow_exceptions=*/false);
    if (report.is_object()) {
      for (const char* key : {"hash", "simulated", "bursts", "accuracy"}) {
        if (report.contains(key)) sidecar[key] = report[key];
      }
    }
  }
  if (sidecar.value("simulated", false)) sidecar["notice"] = "SIMULATED";
  ENAMEL_TRY(host::write_mesh(path, file.mesh));
  ENAMEL_TRY(write_file(path + ".json", json_text(sidecar, 1) + "\n"));
  std::puts(path.c_str());
  return 0;
}

}  // namespace

Run add_export(CLI::App& app) {
  auto o = std::make_shared<ExportOptions>();
  app.add_option("SESSION", o->session, "session or output folder")->required();
  app.add_option("--format", o->format, "stl, ply or obj")
      ->check(CLI::IsMember({"stl", "ply", "obj"}))
      ->capture_default_str();
  app.add_option("--out", o->out, "file to write (default: SESSION/export.FORMAT)");
  return [o]() -> Result<int> { return run_export(*o); };
}

}  // namespace enamel::app
