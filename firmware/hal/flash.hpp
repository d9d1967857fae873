// Flash memory as update and bootloader see it, and a part of it that cannot be left.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace enamel::fw {

enum class FlashStatus : std::uint8_t { kOk, kOutside, kUnaligned, kFailed };

/// NOR or eMMC behind a translation. Not thread-safe. No call allocates.
class Flash {
 public:
  virtual ~Flash() = default;
  [[nodiscard]] virtual std::uint64_t size() const noexcept = 0;
  [[nodiscard]] virtual FlashStatus read(std::uint64_t offset, std::span<std::byte> out) const noexcept = 0;
  /// Sets one erase block to 0xFF; `offset` is its start.
  [[nodiscard]] virtual FlashStatus erase(std::uint64_t offset) noexcept = 0;
  /// Writes erased bytes. A supply that fails meanwhile leaves what was not yet written, and garbage in the 512 bytes
  /// that were being written.
  [[nodiscard]] virtual FlashStatus program(std::uint64_t offset, std::span<const std::byte> bytes) noexcept = 0;
};

inline constexpr std::uint32_t kEraseBlock = 65536;

/// A window: offsets count from its start, nothing outside it can be reached. Whoever holds only regions cannot touch
/// what lies beside them.
class FlashRegion {
 public:
  FlashRegion(Flash& flash, std::uint64_t start, std::uint64_t size) noexcept
      : flash_(&flash), start_(start), size_(size) {}

  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  [[nodiscard]] FlashStatus read(std::uint64_t offset, std::span<std::byte> out) const noexcept {
    return inside(offset, out.size()) ? flash_->read(start_ + offset, out) : FlashStatus::kOutside;
  }
  [[nodiscard]] FlashStatus erase(std::uint64_t offset) noexcept {
    return inside(offset, kEraseBlock) ? flash_->erase(start_ + offset) : FlashStatus::kOutside;
  }
  [[nodiscard]] FlashStatus program(std::uint64_t offset, std::span<const std::byte> bytes) noexcept {
    return inside(offset, bytes.size()) ? flash_->program(start_ + offset, bytes) : FlashStatus::kOutside;
  }

 private:
  [[nodiscard]] bool inside(std::uint64_t offset, std::uint64_t length) const noexcept {
    return offset <= size_ && length <= size_ - offset;
  }

  Flash* flash_;
  std::uint64_t start_;
  std::uint64_t size_;
};

}  // namespace enamel::fw
