#include "host/app/desktop/write_base.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "host/app/desktop/desktop_options.hpp"
#include "host/app/input.hpp"
#include "host/mesh_files/mesh_file.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/base/log.hpp"

namespace enamel::app {
namespace {

std::optional<Vec3d> recorded_up(const std::string& run) {
  std::error_code ignored;
  const std::string path = run + "/capture.mcap";
  if (!std::filesystem::exists(path, ignored)) return std::nullopt;
  const auto stream = host::open_bursts(path);
  if (!stream) return std::nullopt;
  const auto mount = mount_for({}, stream->get());
  return mount ? std::optional(up_of(mount->mount)) : std::nullopt;
}

Result<void> add_to_report(const std::string& path, const host::ClosedMesh& closed) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return {};
  ENAMEL_TRY_ASSIGN(const std::string text, read_file(path));
  auto report = nlohmann::ordered_json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!report.is_object()) {
    log::warn("base", "{} is no report: what was made up is not told there", path);
    return {};
  }
  report["base"] = nlohmann::ordered_json::parse(host::base_json(closed));
  return write_file(path, json_text(report, 1) + "\n");
}

}  // namespace

Vec3d up_of(const calib::Mount& mount) {
  const calib::Triple& d = mount.rotation.direction;
  return d[2] < 0 ? Vec3d(d[0], d[1], d[2]) : Vec3d(-d[0], -d[1], -d[2]);
}

Result<host::ClosedMesh> write_base_of_run(const std::string& run, host::BaseConfig config) {
  ENAMEL_TRY_ASSIGN(const host::MeshFile file, host::read_measured_mesh(run + "/mesh.ply"));
  if (!config.up) config.up = recorded_up(run);
  ENAMEL_TRY_ASSIGN(auto closed, host::close_base(file.mesh, config));
  for (const char* name : {"/closed.ply", "/closed.stl"}) ENAMEL_TRY(host::write_closed(run + name, closed));
  ENAMEL_TRY(add_to_report(run + "/report.json", closed));
  return closed;
}

}  // namespace enamel::app
