// Flash memory that can lose its supply at any write: simulation, with cheap snapshots.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "firmware/hal/flash.hpp"

namespace enamel::fw {

/// Programming goes sector by sector, erasing block by block; each is one operation at which the supply may fail.
/// Copies share what they have in common (copy on write). Programming a byte that is not erased fails, as on the real
/// part.
class FlashModel final : public Flash {
 public:
  static constexpr std::size_t kSector = 512;

  struct Operation {
    std::uint64_t index = 0;           ///< counts from 0
    std::uint64_t offset = 0;          ///< first byte
    std::size_t length = 0;            ///< kEraseBlock for an erase, up to kSector for a program
    std::span<const std::byte> bytes;  ///< what is programmed; empty for an erase
    [[nodiscard]] bool erase() const noexcept { return bytes.empty(); }
  };

  explicit FlashModel(std::uint64_t size);

  [[nodiscard]] std::uint64_t size() const noexcept override { return blocks_.size() * std::uint64_t{kEraseBlock}; }
  [[nodiscard]] FlashStatus read(std::uint64_t offset, std::span<std::byte> out) const noexcept override;
  [[nodiscard]] FlashStatus erase(std::uint64_t offset) noexcept override;
  [[nodiscard]] FlashStatus program(std::uint64_t offset, std::span<const std::byte> bytes) noexcept override;

  /// Called before each operation with the memory as it is: a test copies it and cuts there.
  void watch(std::function<void(const Operation&)> watcher) { watcher_ = std::move(watcher); }
  /// The supply fails in operation `index`: of its bytes the first `whole` are done, the rest of a program is noise
  /// from `seed`, an erase leaves noise in the whole block. Nothing is written or read after it.
  void cut_at(std::uint64_t index, std::size_t whole, std::uint64_t seed);
  /// Power comes back; nothing else changes.
  void restore_power() noexcept;

  /// Does to the memory what a supply that fails in `op` does: for cuts of a copy.
  void tear(const Operation& op, std::size_t whole, std::uint64_t seed);

  [[nodiscard]] std::uint64_t operations() const noexcept { return operations_; }
  /// Equal numbers mean equal content, for the blocks of [offset, offset + length).
  [[nodiscard]] std::vector<std::uint64_t> versions(std::uint64_t offset, std::uint64_t length) const;

 private:
  struct Block {
    std::vector<std::byte> bytes;
    std::uint64_t version = 0;
  };
  struct Cut {
    std::uint64_t index = 0;
    std::size_t whole = 0;
    std::uint64_t seed = 0;
  };

  [[nodiscard]] Block& own(std::uint64_t offset);
  [[nodiscard]] bool begin(const Operation& op);

  std::vector<std::shared_ptr<Block>> blocks_;
  std::function<void(const Operation&)> watcher_;
  std::uint64_t operations_ = 0;
  std::optional<Cut> cut_;
  bool powered_ = true;
};

}  // namespace enamel::fw
