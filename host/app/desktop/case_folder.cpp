#include "host/app/desktop/case_folder.hpp"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "calib/model/rig.hpp"
#include "host/app/desktop/desktop_options.hpp"
#include "host/app/input.hpp"
#include "host/app/out_folder.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/log.hpp"

namespace enamel::app {
namespace {

namespace fs = std::filesystem;

bool has(const fs::path& file) {
  std::error_code ignored;
  return fs::exists(file, ignored);
}

bool was_scanned(const fs::path& part) { return has(part / "capture.mcap") || has(part / "mesh.ply"); }

void add_report(const fs::path& part, host::PartFacts& facts) {
  const auto text = read_file((part / "report.json").string());
  if (!text) return;
  const nlohmann::json report = nlohmann::json::parse(*text, nullptr, /*allow_exceptions=*/false);
  if (!report.is_object()) return;
  facts.simulated = report.contains("simulated") && report["simulated"] == true;
  if (report.contains("calibration") && report["calibration"].is_object() && report["calibration"].contains("serial") &&
      report["calibration"]["serial"].is_string())
    facts.rig_serial = report["calibration"]["serial"];
  if (!report.contains("desktop") || !report["desktop"].is_object()) return;
  const nlohmann::json& desktop = report["desktop"];
  if (desktop.contains("stops") && desktop["stops"].is_array()) facts.stops = desktop["stops"].size();
  if (desktop.contains("fine_rms_um") && desktop["fine_rms_um"].is_number()) facts.fine_rms_um = desktop["fine_rms_um"];
}

void add_recording(const fs::path& part, host::PartFacts& facts) {
  const std::string path = (part / "capture.mcap").string();
  if (!has(path)) return;
  const auto stream = host::open_bursts(path);
  if (!stream) {
    log::warn("case", "{}", stream.error().message());
    return;
  }
  facts.scanned_at = host::recorded_at((*stream)->info());
  facts.simulated = facts.simulated || host::says_simulated((*stream)->info());
  if (const auto mount = mount_for({}, stream->get())) facts.mount_serial = mount->mount.serial;
  const auto rig = calib::parse_rig((*stream)->rig_text());
  if (rig && facts.rig_serial.empty()) facts.rig_serial = rig->serial;
}

/// "upper.2" is an older one of "upper".
std::string part_of(const std::string& folder) {
  const std::size_t dot = folder.rfind('.');
  const bool numbered = dot != std::string::npos && dot + 1 < folder.size() &&
                        std::all_of(folder.begin() + static_cast<std::ptrdiff_t>(dot) + 1, folder.end(),
                                    [](char c) { return c >= '0' && c <= '9'; });
  return numbered ? folder.substr(0, dot) : std::string();
}

std::vector<std::string> folders_in(const std::string& folder) {
  std::error_code ec;
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder, ec))
    if (entry.is_directory(ec)) names.push_back(entry.path().filename().string());
  std::ranges::sort(names);
  return names;
}

/// One sentence for each scan in the case whose folder has no part's name: it would be missed without a word.
std::vector<std::string> unnamed_scans(const std::string& folder) {
  std::vector<std::string> out;
  for (const std::string& name : folders_in(folder)) {
    const auto named = host::check_part(part_of(name).empty() ? name : part_of(name));
    if (!named && was_scanned(fs::path(folder) / name))
      out.push_back("a scan is left out for its folder's name: " + named.error().detail);
  }
  return out;
}

}  // namespace

Result<std::vector<host::PartFacts>> read_case(const std::string& folder) {
  std::error_code ec;
  if (!fs::is_directory(folder, ec)) return fail(ErrorCode::kFileNotFound, folder + ": no folder of a case");
  const std::vector<std::string> names = folders_in(folder);
  std::vector<host::PartFacts> out;
  for (const std::string& name : names) {
    const fs::path part = fs::path(folder) / name;
    if (!host::check_part(name) || !was_scanned(part)) continue;
    host::PartFacts facts;
    facts.name = name;
    facts.scanned = has(part / "mesh.ply");
    add_report(part, facts);
    add_recording(part, facts);
    for (const std::string& other : names)
      if (part_of(other) == name) facts.older.push_back(other);
    out.push_back(std::move(facts));
  }
  return out;
}

Result<std::string> write_case(const std::string& folder, const host::PlacedCase* placed) {
  ENAMEL_TRY_ASSIGN(const auto parts, read_case(folder));
  std::vector<std::string> warnings = host::serial_doubts(parts);
  for (std::string& unnamed : unnamed_scans(folder)) warnings.push_back(std::move(unnamed));
  for (const std::string& warning : warnings) log::warn("case", "{}", warning);
  std::string text = host::case_json(parts, placed, warnings);
  ENAMEL_TRY(write_file(folder + "/case.json", text));
  return text;
}

void drop_placed(const std::string& folder) {
  std::error_code ec;
  std::vector<fs::path> there;
  for (const auto& entry : fs::directory_iterator(folder, ec)) there.push_back(entry.path());
  for (const fs::path& path : there) {
    const fs::path name = path.filename();
    if (name == "case.png" || (name.extension() == ".stl" && host::check_part(name.stem().string())))
      fs::remove(path, ec);
  }
}

Result<PartFolder> PartFolder::open(const std::string& case_folder, const std::string& part, bool again) {
  ENAMEL_TRY(host::check_part(part));
  const std::string path = case_folder + "/" + part;
  if (!was_scanned(path)) return PartFolder(path, "");
  if (!again)
    return fail(ErrorCode::kFileWrite, path +
                                           ": this part was scanned, and is not written over; --again scans it anew "
                                           "and keeps the old one beside it");
  if (in_use(path)) return fail(ErrorCode::kFileWrite, path + ": another run writes into it");
  std::string older;
  for (int n = 1; older.empty() || has(older); ++n) older = path + "." + std::to_string(n);
  std::error_code ec;
  fs::rename(path, older, ec);
  if (ec) return fail(ErrorCode::kFileWrite, older + ": " + ec.message());
  log::info("case", "the scan before is kept in {}", older);
  return PartFolder(path, older);
}

bool PartFolder::close() const {
  if (was_scanned(path_)) return true;
  if (older_.empty()) return false;
  std::error_code ec;
  fs::remove(path_, ec);  // unless something is in it
  if (!has(path_)) fs::rename(older_, path_, ec);
  return false;
}

}  // namespace enamel::app
