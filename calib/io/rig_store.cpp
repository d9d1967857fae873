#include "calib/io/rig_store.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>

#include "calib/io/rig_details.hpp"
#include "protocol/base/file.hpp"

namespace enamel::calib {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHashDigits = 8;

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// A rig that may become current: whole, unchanged since it was solved, of a probe with a name.
Result<RigDetails> usable(const std::string& text, const std::string& what) {
  ENAMEL_TRY_ASSIGN(const Rig rig, parse_rig(text));
  const RigDetails details = read_rig_details(rig);
  if (details.seal == RigSeal::kAbsent)
    return fail(ErrorCode::kRigInvalid, what + " carries no sha256: design values are no calibration, solve it first");
  if (details.seal == RigSeal::kBroken)
    return fail(ErrorCode::kRigInvalid, what + ": its sha256 is not that of its content; it was changed after solving");
  if (!is_storable_serial(rig.serial))
    return fail(ErrorCode::kRigInvalid, what + ": serial '" + rig.serial + "' names no probe; write it into rig.json");
  return details;
}

/// 2026-01-31T12:00:00Z and 1a2b3c4d… -> 20260131T120000Z-1a2b3c4d. A file says what it likes: no separator passes.
std::string id_of(const RigDetails& details) {
  std::string id;
  for (const char c : details.calibrated_at)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) id += c;
  return (id.empty() ? "undated" : id) + "-" + details.sha256.substr(0, kHashDigits);
}

}  // namespace

bool is_storable_serial(const std::string& serial) {
  if (serial.empty() || serial.size() > 64 || std::isalnum(static_cast<unsigned char>(serial[0])) == 0) return false;
  return std::all_of(serial.begin(), serial.end(),
                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.'; });
}

std::string RigStore::default_folder() {
  if (std::string own = environment("ENAMEL_CALIBRATIONS"); !own.empty()) return own;
  const std::string data = environment("XDG_DATA_HOME");
  return (data.empty() ? environment("HOME") + "/.local/share" : data) + "/enamel/calibrations";
}

Result<StoredRig> RigStore::install(const std::string& text) const {
  ENAMEL_TRY_ASSIGN(const RigDetails details, usable(text, "the calibration"));
  const std::string folder = folder_of(details.serial);
  StoredRig stored{.id = id_of(details), .path = {}, .calibrated_at = details.calibrated_at, .is_current = true};
  stored.path = folder + "/" + stored.id + ".json";
  ENAMEL_TRY(make_folder(folder));
  ENAMEL_TRY(write_file(stored.path, text));
  ENAMEL_TRY(write_file(folder + "/current", stored.id + "\n"));
  return stored;
}

std::vector<std::string> RigStore::serials() const {
  std::vector<std::string> out;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder_, ignored))
    if (entry.is_directory(ignored)) out.push_back(entry.path().filename().string());
  std::sort(out.begin(), out.end());
  return out;
}

Result<std::vector<StoredRig>> RigStore::list(const std::string& serial) const {
  std::vector<StoredRig> out;
  if (is_storable_serial(serial)) {
    std::string current = read_file(folder_of(serial) + "/current").value_or("");
    current.erase(std::find(current.begin(), current.end(), '\n'), current.end());
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder_of(serial), ignored)) {
      if (entry.path().extension() != ".json") continue;
      const auto rig = load_rig(entry.path().string());
      const std::string id = entry.path().stem().string();
      out.push_back({id, entry.path().string(), rig ? read_rig_details(*rig).calibrated_at : "damaged", id == current});
    }
  }
  if (out.empty()) {
    return fail(ErrorCode::kFileNotFound,
                folder_ + " holds no calibration of probe '" + serial + "'; `solve --install` puts one there");
  }
  std::sort(out.begin(), out.end(), [](const StoredRig& a, const StoredRig& b) { return a.id < b.id; });
  return out;
}

Result<StoredRig> RigStore::revert(const std::string& serial, const std::string& id) const {
  ENAMEL_TRY_ASSIGN(const std::vector<StoredRig> stored, list(serial));
  auto at = std::find_if(stored.begin(), stored.end(),
                         [&](const StoredRig& s) { return id.empty() ? s.is_current : s.id == id; });
  if (at == stored.end()) {
    return fail(ErrorCode::kFileNotFound, (id.empty() ? "no calibration of probe " + serial + " is current"
                                                      : "probe " + serial + " has no " + id) +
                                              "; `enamel calibrate list` names those that --to can take");
  }
  if (id.empty() && at == stored.begin()) {
    return fail(ErrorCode::kFileNotFound, "the current calibration of probe " + serial + ", " + at->id +
                                              ", is the oldest; --to takes a newer one");
  }
  StoredRig chosen = id.empty() ? *std::prev(at) : *at;
  ENAMEL_TRY_ASSIGN(const std::string text, read_file(chosen.path));
  ENAMEL_TRY_ASSIGN(const RigDetails details, usable(text, chosen.path));
  if (details.serial != serial)
    return fail(ErrorCode::kRigForeign, chosen.path + " is of probe " + details.serial + ", not of " + serial);
  ENAMEL_TRY(write_file(folder_of(serial) + "/current", chosen.id + "\n"));
  chosen.is_current = true;
  return chosen;
}

}  // namespace enamel::calib
