#include "protocol/base/file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace enamel {

namespace {

bool write_all(int fd, std::string_view content) {
  while (!content.empty()) {
    const ssize_t n = ::write(fd, content.data(), content.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    content.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

}  // namespace

Result<std::string> read_file(const std::string& path) {
  std::error_code ec;
  if (!std::filesystem::exists(path, ec)) return fail(ErrorCode::kFileNotFound, path);
  if (std::filesystem::is_directory(path, ec)) return fail(ErrorCode::kFileRead, path + " is a folder");
  std::ifstream in(path, std::ios::binary);
  std::ostringstream content;
  if (in.peek() != std::ifstream::traits_type::eof()) content << in.rdbuf();
  if (!in || !content) return fail(ErrorCode::kFileRead, path);
  return std::move(content).str();
}

Result<void> write_file(const std::string& path, std::string_view content, Sync sync) {
  const std::string temporary = path + ".partial";
  const int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (fd < 0) return fail(ErrorCode::kFileWrite, path + ": " + std::strerror(errno));
  bool written = write_all(fd, content);
  // Pipes and devices cannot be synchronised.
  if (written && sync == Sync::kNow && ::fdatasync(fd) != 0) written = errno == EINVAL || errno == EROFS;
  const int reason = errno;
  const bool closed = ::close(fd) == 0;
  if (!written || !closed || ::rename(temporary.c_str(), path.c_str()) != 0) {
    const std::string why = std::strerror(written ? errno : reason);
    ::unlink(temporary.c_str());
    return fail(ErrorCode::kFileWrite, path + ": " + why);
  }
  return {};
}

Result<void> make_folder(const std::string& path) {
  std::error_code ec;
  std::filesystem::create_directories(path, ec);
  if (ec) return fail(ErrorCode::kFileWrite, path + ": " + ec.message());
  return {};
}

}  // namespace enamel
