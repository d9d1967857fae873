#include "protocol/mcap/file_source.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace enamel::mcap {

FileSource::~FileSource() {
  if (fd_ >= 0) ::close(fd_);
}

Result<void> FileSource::open(const std::string& path) {
  path_ = path;
  fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd_ < 0) {
    const ErrorCode code = errno == ENOENT || errno == ENOTDIR ? ErrorCode::kFileNotFound : ErrorCode::kFileRead;
    return fail(code, path + ": " + std::generic_category().message(errno));
  }
  struct stat info {};
  if (::fstat(fd_, &info) != 0) return fail(ErrorCode::kFileRead, path + ": " + std::generic_category().message(errno));
  if (!S_ISREG(info.st_mode)) return fail(ErrorCode::kFileRead, path + ": not a plain file");
  size_ = static_cast<std::uint64_t>(info.st_size);
  return {};
}

Result<std::vector<std::byte>> FileSource::read(std::uint64_t offset, std::uint64_t n) const {
  if (offset > size_ || n > size_ - offset)
    return fail(ErrorCode::kCaptureCorrupt, path_ + ": points outside the file");
  std::vector<std::byte> out(n);
  std::size_t done = 0;
  while (done < n) {
    const ssize_t got = ::pread(fd_, out.data() + done, n - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return fail(ErrorCode::kFileRead, path_ + ": " + std::generic_category().message(errno));
    if (got == 0) return fail(ErrorCode::kFileRead, path_ + ": became shorter while it was read");
    done += static_cast<std::size_t>(got);
  }
  return out;
}

}  // namespace enamel::mcap
