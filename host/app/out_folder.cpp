#include "host/app/out_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>

#include "protocol/base/file.hpp"
#include "protocol/base/log.hpp"
#include "protocol/base/utc.hpp"

namespace enamel::app {

namespace {

namespace fs = std::filesystem;

constexpr std::array kResults{"mesh.ply",    "mesh.stl",        "poses.csv",       "stages.csv",      "report.json",
                              "preview.png", "deviation.png",   "calibrate.json",  "export.stl",      "export.ply",
                              "export.obj",  "export.stl.json", "export.ply.json", "export.obj.json", "export.obj.mtl",
                              "probe.log",   "probe.out",       "closed.ply",      "closed.stl",      "defects.png"};
constexpr std::array kSegmentResults{"mesh.ply", "poses.csv"};

tl::unexpected<Error> not_usable(const std::string& path, const std::string& why) {
  return fail(ErrorCode::kFileWrite, path + ": " + why);
}

// A folder may exist and yet not be writable: told now, not when the work is done.
Result<void> try_to_write(const std::string& path) {
  std::string name = path + "/.enamel-XXXXXX";
  const int fd = ::mkstemp(name.data());
  if (fd < 0) return not_usable(path, std::strerror(errno));
  const bool written = ::write(fd, "x", 1) == 1;
  const int reason = errno;
  ::close(fd);
  ::unlink(name.c_str());
  if (!written) return not_usable(path, std::strerror(reason));
  return {};
}

void remove_files(const fs::path& folder, const auto& names) {
  std::error_code ec;
  for (const char* name : names) fs::remove(folder / name, ec);
}

void clear_segments(const fs::path& segments) {
  std::error_code ec;
  for (const auto& entry : fs::directory_iterator(segments, ec)) {
    if (!entry.is_directory(ec)) continue;
    remove_files(entry.path(), kSegmentResults);
    fs::remove(entry.path(), ec);  // unless something else is in it
  }
  fs::remove(segments, ec);
}

}  // namespace

Result<OutFolder> OutFolder::open(const std::string& path) {
  ENAMEL_TRY(make_folder(path));
  const int fd = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return not_usable(path, std::strerror(errno));
  OutFolder folder(path, fd);
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) return not_usable(path, "another run writes into it; choose another folder");
    log::warn("out", "{}: this file system knows no locks; let one run at a time write there", path);
  }
  ENAMEL_TRY(try_to_write(path));
  return folder;
}

bool in_use(const std::string& folder) {
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return false;
  const bool held = ::flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(fd);
  return held;
}

Result<void> usable_folder(const std::string& path) {
  ENAMEL_TRY(make_folder(path));
  return try_to_write(path);
}

OutFolder::OutFolder(OutFolder&& other) noexcept : path_(std::move(other.path_)), fd_(std::exchange(other.fd_, -1)) {}

OutFolder::~OutFolder() {
  if (fd_ >= 0) ::close(fd_);
}

void OutFolder::clear_results() const {
  remove_files(path_, kResults);
  remove_files(fs::path(path_) / "uncalibrated", kResults);
  clear_segments(fs::path(path_) / "segments");
}

bool OutFolder::has_recording() const {
  std::error_code ec;
  return fs::exists(fs::path(path_) / "capture.mcap", ec);
}

Result<std::string> new_session_folder() {
  ENAMEL_TRY(make_folder("out"));
  std::string date_time;
  for (const char c : utc_text(wall_time())) {
    if (c >= '0' && c <= '9') date_time += c;
    if (c == 'T') date_time += '-';
  }
  const std::string dated = "session-" + date_time;
  std::string name = dated;
  // Two scans begun in the same second get folders of their own: creating one is what decides.
  std::error_code ec;
  for (int again = 2; !fs::create_directory("out/" + name, ec); ++again) {
    if (ec) return not_usable("out/" + name, ec.message());
    name = dated + "-" + std::to_string(again);
  }
  const fs::path link = "out/session";
  if (fs::is_symlink(link, ec)) fs::remove(link, ec);
  if (!fs::exists(link, ec)) fs::create_directory_symlink(name, link, ec);  // a convenience: none on FAT
  return "out/" + name;
}

void drop_if_empty(const std::string& session_folder) {
  std::error_code ec;
  if (!fs::is_empty(session_folder, ec) || ec) return;
  fs::remove(session_folder, ec);
  const fs::path link = "out/session";
  if (fs::is_symlink(link, ec) && !fs::exists(link, ec)) fs::remove(link, ec);
}

}  // namespace enamel::app
