// enamel desktop case: the parts of a case laid on each other, and written in one frame.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host/app/desktop/case_folder.hpp"
#include "host/app/desktop/subcommand.hpp"
#include "host/app/out_folder.hpp"
#include "host/mesh_files/mesh_file.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/log.hpp"

namespace enamel::app {
namespace {

namespace fs = std::filesystem;

struct CaseOptions {
  std::string folder;
  bool json = false;
};

Result<host::CaseParts> load_parts(const std::string& folder, const std::vector<host::PartFacts>& facts) {
  host::CaseParts out;
  for (const host::PartFacts& part : facts) {
    if (!part.scanned) continue;
    const std::string path = folder + "/" + part.name + "/mesh.ply";
    ENAMEL_TRY_ASSIGN(host::MeshFile file, host::read_measured_mesh(path));
    if (!file.origin_mm.isZero(0)) return fail(ErrorCode::kMeshInvalid, path + ": too far from the origin for a scan");
    log::info("case", "looking at {}: {} triangles", part.name, file.mesh.triangles.size());
    out[part.name] = std::make_unique<const host::LaidPart>(std::move(file.mesh));
  }
  return out;
}

/// PART.stl of all that stand in the common frame, and the picture; those of a run before are taken away.
Result<void> write_placed(const std::string& folder, const host::CaseParts& parts, const host::PlacedCase& placed) {
  drop_placed(folder);
  if (placed.T_frame_part.size() < 2) return {};
  for (const auto& [name, T] : placed.T_frame_part) {
    if (name == host::kBite) continue;  // its frame, and no part to hand on
    Mesh mesh = parts.at(name)->surface.mesh();
    for (Vec3f& v : mesh.vertices) v = (T * v.cast<double>()).cast<float>();
    ENAMEL_TRY(write_file(folder + "/" + name + ".stl", host::stl_bytes(mesh)));
  }
  const auto png = host::case_png(parts, placed);
  return write_file(folder + "/case.png", {reinterpret_cast<const char*>(png.data()), png.size()});
}

std::string line_of(const host::PlacedPart& part) {
  if (!part.placement) return fmt::format("{:<8} not placed: {}\n", part.name, part.reason);
  const host::Placement& p = *part.placement;
  return fmt::format(
      "{:<8} on {:<6} {:5.0f} mm2, form {:.1f} um, known to +-{:.1f} um in the middle, {:.1f} at its end\n", part.name,
      part.onto, p.area_mm2, 1e3 * p.form_rms_mm, 1e3 * p.sigma_mm, 1e3 * p.far_sigma_mm);
}

/// That all could be placed which has something to be placed on, or why not.
Result<int> verdict(const std::string& folder, const host::PlacedCase& placed) {
  std::string missing;
  for (const host::PlacedPart& part : placed.parts)
    if (!part.placement) missing += (missing.empty() ? "" : "; ") + part.name + ": " + part.reason;
  if (missing.empty()) return 0;
  return fail(ErrorCode::kQualityGate, folder + ": not placed: " + missing);
}

Result<int> run_case(const CaseOptions& o) {
  std::error_code ec;
  if (!fs::is_directory(o.folder, ec)) return fail(ErrorCode::kFileNotFound, o.folder + ": no folder of a case");
  ENAMEL_TRY_ASSIGN(const OutFolder lock, OutFolder::open(o.folder));
  ENAMEL_TRY_ASSIGN(const auto facts, read_case(o.folder));
  if (facts.empty())
    return fail(ErrorCode::kEmptyInput,
                o.folder + ": holds no part; scan one with `enamel desktop scan --part upper --out " + o.folder + "`");
  ENAMEL_TRY_ASSIGN(const host::CaseParts parts, load_parts(o.folder, facts));
  const host::PlacedCase placed = host::place_case(parts, {});
  ENAMEL_TRY(write_placed(o.folder, parts, placed));
  ENAMEL_TRY_ASSIGN(const std::string text, write_case(o.folder, &placed));
  if (o.json) {
    std::fputs(text.c_str(), stdout);
  } else {
    for (const host::PlacedPart& part : placed.parts) std::fputs(line_of(part).c_str(), stdout);
  }
  return verdict(o.folder, placed);
}

}  // namespace

DesktopCommand add_desktop_case(CLI::App& app) {
  CLI::App* sub = app.add_subcommand("case", "lay the parts of a case on each other: jaws by the bite, dies on jaws");
  auto o = std::make_shared<CaseOptions>();
  sub->add_option("CASE", o->folder, "folder that `enamel desktop scan --part` wrote parts into")->required();
  sub->add_flag("--json", o->json, "case.json on stdout");
  return {sub, [o] { return run_case(*o); }};
}

}  // namespace enamel::app
