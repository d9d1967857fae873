// The folder of a case: one folder a part, and case.json.
#pragma once

#include <string>
#include <vector>

#include "host/cases/case_file.hpp"
#include "protocol/base/result.hpp"

namespace enamel::app {

/// What lies in the folder now, by names of parts. Errors: kFileNotFound where there is no such folder.
[[nodiscard]] Result<std::vector<host::PartFacts>> read_case(const std::string& folder);

/// Writes case.json anew from what lies in the folder, and gives its text; `placed` as host::case_json(). Warns of
/// serials that differ and of scans whose folder has no part's name. Errors: of read_case; kFileWrite.
[[nodiscard]] Result<std::string> write_case(const std::string& folder, const host::PlacedCase* placed);

/// Takes away what `enamel desktop case` made of the parts: PART.stl and case.png.
void drop_placed(const std::string& folder);

/// The part's folder for a new scan. A part that was scanned is not written over: `again` moves its folder to PART.N,
/// the next free number. Put back by close() where no scan came about. Errors: kUsage, kFileWrite.
class PartFolder {
 public:
  [[nodiscard]] static Result<PartFolder> open(const std::string& case_folder, const std::string& part, bool again);
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  /// Whether a scan came about.
  [[nodiscard]] bool close() const;

 private:
  PartFolder(std::string path, std::string older) : path_(std::move(path)), older_(std::move(older)) {}
  std::string path_, older_;  ///< older_: where the scan before is now; empty: there was none
};

}  // namespace enamel::app
