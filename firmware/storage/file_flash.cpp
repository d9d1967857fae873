#include "firmware/storage/file_flash.hpp"

#include <fcntl.h>
#include <linux/fs.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace enamel::fw {
namespace {

std::uint64_t size_of(int fd) noexcept {
  struct stat info {};
  if (::fstat(fd, &info) != 0) return 0;
  if (S_ISREG(info.st_mode)) return static_cast<std::uint64_t>(info.st_size);
  std::uint64_t bytes = 0;
  return S_ISBLK(info.st_mode) && ::ioctl(fd, BLKGETSIZE64, &bytes) == 0 ? bytes : 0;
}

}  // namespace

Result<std::unique_ptr<FileFlash>> FileFlash::open(const std::string& path, std::uint64_t size) {
  const int fd = ::open(path.c_str(), O_RDWR | O_DSYNC | O_CLOEXEC);
  if (fd < 0)
    return fail(errno == ENOENT ? ErrorCode::kFileNotFound : ErrorCode::kFlash, path + ": " + std::strerror(errno));
  std::unique_ptr<FileFlash> flash(new FileFlash(fd, size));
  if (size_of(fd) < size) {
    return fail(ErrorCode::kFlash,
                path + " holds " + std::to_string(size_of(fd)) + " bytes; " + std::to_string(size) + " are needed");
  }
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0) return fail(ErrorCode::kFlash, path + " is open in another updater");
  return flash;
}

FileFlash::~FileFlash() { ::close(fd_); }

FlashStatus FileFlash::read(std::uint64_t offset, std::span<std::byte> out) const noexcept {
  if (!inside(offset, out.size())) return FlashStatus::kOutside;
  while (!out.empty()) {
    const ssize_t n = ::pread(fd_, out.data(), out.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return FlashStatus::kFailed;
    out = out.subspan(static_cast<std::size_t>(n));
    offset += static_cast<std::uint64_t>(n);
  }
  return FlashStatus::kOk;
}

bool FileFlash::write(std::uint64_t offset, std::span<const std::byte> bytes) const noexcept {
  const auto start = static_cast<off_t>(offset), length = static_cast<off_t>(bytes.size());
  while (!bytes.empty()) {
    const ssize_t n = ::pwrite(fd_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(n));
    offset += static_cast<std::uint64_t>(n);
  }
  static_cast<void>(::posix_fadvise(fd_, start, length, POSIX_FADV_DONTNEED));
  return true;
}

FlashStatus FileFlash::erase(std::uint64_t offset) noexcept {
  if (offset % kEraseBlock != 0) return FlashStatus::kUnaligned;
  if (!inside(offset, kEraseBlock)) return FlashStatus::kOutside;
  std::array<std::byte, 16384> erased;
  erased.fill(std::byte{0xFF});
  for (std::uint64_t at = offset; at < offset + kEraseBlock; at += erased.size()) {
    if (!write(at, erased)) return FlashStatus::kFailed;
  }
  return FlashStatus::kOk;
}

FlashStatus FileFlash::program(std::uint64_t offset, std::span<const std::byte> bytes) noexcept {
  if (!inside(offset, bytes.size())) return FlashStatus::kOutside;
  return write(offset, bytes) ? FlashStatus::kOk : FlashStatus::kFailed;
}

}  // namespace enamel::fw
