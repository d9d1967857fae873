#include "protocol/mcap/file_sink.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "protocol/base/crc32.hpp"

namespace enamel::mcap {

tl::unexpected<Error> FileSink::system_fail(const char* what) const {
  return fail(ErrorCode::kFileWrite, path_ + ": " + what + ": " + std::generic_category().message(errno));
}

Result<void> FileSink::open(const std::string& path) {
  path_ = path;
  fd_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (fd_ < 0) return system_fail("open");
  return {};
}

Result<void> FileSink::append(ByteSpan bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::write(fd_, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      auto error = system_fail("write");
      // Not a plain file (/dev/full): there is nothing to cut.
      static_cast<void>(::ftruncate(fd_, static_cast<off_t>(position_)) == 0);
      return error;
    }
    done += static_cast<std::size_t>(n);
  }
  position_ += bytes.size();
  crc_ = crc32(bytes, crc_);
  return {};
}

Result<void> FileSink::sync_and_close() {
  // Pipes and devices cannot be synchronised; a disk that is full or broken says so here at the latest.
  if (::fdatasync(fd_) != 0 && errno != EINVAL && errno != EROFS) return system_fail("sync");
  const int rc = ::close(fd_);
  fd_ = -1;
  if (rc != 0) return system_fail("close");
  return {};
}

void FileSink::close_quietly() noexcept {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

}  // namespace enamel::mcap
