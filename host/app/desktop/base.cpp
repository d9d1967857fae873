// enamel desktop base: a watertight base under a scanned surface.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host/app/desktop/subcommand.hpp"
#include "host/app/desktop/write_base.hpp"
#include "host/mesh_files/mesh_file.hpp"

namespace enamel::app {
namespace {

namespace fs = std::filesystem;

struct BaseOptions {
  std::string input, out;
  std::vector<double> up;
  host::BaseConfig config = {};
  bool json = false;
};

Result<host::ClosedMesh> close_file(const BaseOptions& o, const host::BaseConfig& config) {
  if (o.out.empty()) return fail(ErrorCode::kUsage, "a mesh needs --out FILE.ply, .stl or .obj for the closed one");
  std::error_code ec;
  if (fs::equivalent(o.input, o.out, ec))
    return fail(ErrorCode::kUsage, o.out + ": the scanned surface is not written over; choose another file");
  ENAMEL_TRY_ASSIGN(const host::MeshFile file, host::read_measured_mesh(o.input));
  if (!file.origin_mm.isZero(0))
    return fail(ErrorCode::kMeshInvalid, o.input + ": lies farther than 1 m from the origin");
  ENAMEL_TRY_ASSIGN(auto closed, host::close_base(file.mesh, config));
  ENAMEL_TRY(host::write_closed(o.out, closed));
  return closed;
}

Result<host::ClosedMesh> close_run(const BaseOptions& o, const host::BaseConfig& config) {
  ENAMEL_TRY_ASSIGN(auto closed, write_base_of_run(o.input, config));
  if (!o.out.empty()) ENAMEL_TRY(host::write_closed(o.out, closed));
  return closed;
}

Result<int> run_base(const BaseOptions& o) {
  host::BaseConfig config = o.config;
  if (!o.up.empty()) config.up = Vec3d(o.up[0], o.up[1], o.up[2]);
  std::error_code ec;
  ENAMEL_TRY_ASSIGN(const auto closed, fs::is_directory(o.input, ec) ? close_run(o, config) : close_file(o, config));
  if (o.json) {
    std::puts(host::base_json(closed).c_str());
    return 0;
  }
  const std::string text = fmt::format(
      "watertight: {:.1f} mm3, {} piece(s)\nmade up: {} of {} faces; walls {:.1f}, bottom {:.1f}, {} holes {:.1f} "
      "mm2\n",
      closed.check.volume_mm3, closed.pieces, closed.synthetic_faces(), closed.mesh.triangles.size(), closed.wall_mm2,
      closed.bottom_mm2, closed.holes, closed.hole_mm2);
  std::fputs(text.c_str(), stdout);
  return 0;
}

}  // namespace

DesktopCommand add_desktop_base(CLI::App& app) {
  CLI::App* sub =
      app.add_subcommand("base", "close a scanned surface by walls, a flat bottom and patches, tagged synthetic");
  auto o = std::make_shared<BaseOptions>();
  sub->add_option("RUN|MESH", o->input, "folder that a scan or a replay wrote, or a mesh: PLY, STL or OBJ, mm")
      ->required();
  sub->add_option("--out", o->out,
                  "closed mesh: .ply, .stl or .obj (of a folder also closed.ply and closed.stl in it)");
  sub->add_option("--up", o->up,
                  "X Y Z: from the bottom to the teeth (default: the rotation axis of the recording, else "
                  "where the surface as a whole looks)")
      ->expected(3);
  sub->add_option("--below", o->config.below_mm, "of the bottom under the lowest point, mm")
      ->check(CLI::Range(0.1, 100.0))
      ->capture_default_str();
  sub->add_flag("--json", o->json, "one JSON object on stdout");
  return {sub, [o] { return run_base(*o); }};
}

}  // namespace enamel::app
