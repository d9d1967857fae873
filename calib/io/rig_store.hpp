// Accepted calibrations of all probes, kept by serial: FOLDER/<serial>/<id>.json and, naming one of them,
// FOLDER/<serial>/current. An id is the time of capture and the first digits of sha256, so that ids sort by time and
// the same file has one id. Files are written whole or not at all; a calibration is current once `current` names it.
// Not thread-safe against a second writer of the same probe.
#pragma once

#include <string>
#include <vector>

#include "calib/model/rig.hpp"
#include "protocol/base/result.hpp"

namespace enamel::calib {

struct StoredRig {
  std::string id;
  std::string path;
  std::string calibrated_at;  ///< UTC
  bool is_current = false;
};

class RigStore {
 public:
  explicit RigStore(std::string folder) : folder_(std::move(folder)) {}

  /// $ENAMEL_CALIBRATIONS, else $XDG_DATA_HOME/enamel/calibrations, else ~/.local/share/enamel/calibrations.
  [[nodiscard]] static std::string default_folder();

  [[nodiscard]] const std::string& folder() const noexcept { return folder_; }

  /// Keeps a solved rig.json and makes it current. Errors: those of parse_rig; kRigInvalid when the text carries no
  /// sha256 of its own content (design values, or changed after solving) or no serial that can name a folder;
  /// kFileWrite.
  [[nodiscard]] Result<StoredRig> install(const std::string& text) const;

  /// Serials that have calibrations, sorted.
  [[nodiscard]] std::vector<std::string> serials() const;

  /// Calibrations of a probe, oldest first. Errors: kFileNotFound when there are none.
  [[nodiscard]] Result<std::vector<StoredRig>> list(const std::string& serial) const;

  /// Makes calibration `id` current; empty: the one taken before the current one. The file is read and judged first, so
  /// that what becomes current can be used. Errors: kFileNotFound (no such calibration, nothing older), kRigInvalid
  /// (damaged or changed), kRigForeign (the file is of another probe), kFileWrite; the current one then stays.
  [[nodiscard]] Result<StoredRig> revert(const std::string& serial, const std::string& id = {}) const;

 private:
  [[nodiscard]] std::string folder_of(const std::string& serial) const { return folder_ + "/" + serial; }

  std::string folder_;
};

/// Whether a serial can name a folder: 1 to 64 letters, digits, '-', '_' and '.', the first one a letter or digit.
[[nodiscard]] bool is_storable_serial(const std::string& serial);

}  // namespace enamel::calib
