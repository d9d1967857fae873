// The probe's flash as Linux shows it: a block device (eMMC, UBI volume) or a file, behind the HAL.
#pragma once

#include <memory>
#include <string>

#include "firmware/hal/flash.hpp"
#include "protocol/base/result.hpp"

namespace enamel::fw {

/// Every erase and program is on the medium when the call returns (O_DSYNC), and what is read back afterwards comes
/// from the medium, not from the page cache. The device's own translation layer erases; an erase here writes 0xFF.
/// Holds a lock (flock): one updater at a time. Not thread-safe; one descriptor, no heap after open.
class FileFlash final : public Flash {
 public:
  /// Takes the first `size` bytes of the file or device. kFileNotFound; kFlash when it is smaller, cannot be opened for
  /// writing, or is locked by another process.
  [[nodiscard]] static Result<std::unique_ptr<FileFlash>> open(const std::string& path, std::uint64_t size);
  ~FileFlash() override;
  FileFlash(const FileFlash&) = delete;
  FileFlash& operator=(const FileFlash&) = delete;

  [[nodiscard]] std::uint64_t size() const noexcept override { return size_; }
  [[nodiscard]] FlashStatus read(std::uint64_t offset, std::span<std::byte> out) const noexcept override;
  [[nodiscard]] FlashStatus erase(std::uint64_t offset) noexcept override;
  [[nodiscard]] FlashStatus program(std::uint64_t offset, std::span<const std::byte> bytes) noexcept override;

 private:
  FileFlash(int fd, std::uint64_t size) noexcept : fd_(fd), size_(size) {}
  [[nodiscard]] bool inside(std::uint64_t offset, std::uint64_t length) const noexcept {
    return offset <= size_ && length <= size_ - offset;
  }
  [[nodiscard]] bool write(std::uint64_t offset, std::span<const std::byte> bytes) const noexcept;

  int fd_;
  std::uint64_t size_;
};

}  // namespace enamel::fw
