// The folder of a run: nobody else writes into it meanwhile, no recording in it is written over, and what is in it
// afterwards is of this run.
#pragma once

#include <string>

#include "protocol/base/result.hpp"

namespace enamel::app {

/// Holds the folder's lock (flock on the folder itself) until it is destroyed; movable, one owner.
class OutFolder {
 public:
  /// Makes the folder and its parents, locks it, and tries whether it can be written. Where the file system knows no
  /// locks (some network shares) that is logged and the run goes on. Errors: kFileWrite (names the cause: in use by
  /// another run, read-only, full).
  [[nodiscard]] static Result<OutFolder> open(const std::string& path);
  OutFolder(OutFolder&& other) noexcept;
  OutFolder& operator=(OutFolder&&) = delete;
  OutFolder(const OutFolder&) = delete;
  OutFolder& operator=(const OutFolder&) = delete;
  ~OutFolder();

  /// Removes the results of a run before: every file that a run writes or that is made from its mesh. A recording and
  /// files of others stay.
  void clear_results() const;
  /// capture.mcap is there, whole or not.
  [[nodiscard]] bool has_recording() const;
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  OutFolder(std::string path, int fd) noexcept : path_(std::move(path)), fd_(fd) {}
  std::string path_;
  int fd_ = -1;
};

/// Another run holds its lock.
[[nodiscard]] bool in_use(const std::string& folder);

/// Makes the folder and its parents and tries whether it can be written. Errors: kFileWrite.
[[nodiscard]] Result<void> usable_folder(const std::string& path);

/// A new folder out/session-DATE-TIME (UTC) for a scan; out/session is a link to the newest one. Errors: kFileWrite.
[[nodiscard]] Result<std::string> new_session_folder();
/// Takes such a folder, and the link to it, away again when no scan came about.
void drop_if_empty(const std::string& session_folder);

}  // namespace enamel::app
