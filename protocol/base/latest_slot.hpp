// Mailbox of one item: the newest replaces the one not yet taken. For viewers, which want now and not everything.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <utility>

#include "protocol/base/cache_line.hpp"

namespace enamel {

/// Three slots: one the writer fills, one the reader empties, one in the middle that both swap with a single atomic
/// exchange. One writer thread, one reader thread; wait-free on both sides, no allocation.
template <class T>
class LatestSlot {
 public:
  LatestSlot() = default;
  LatestSlot(const LatestSlot&) = delete;
  LatestSlot& operator=(const LatestSlot&) = delete;

  /// Writer. True when an item nobody took was replaced; it is destroyed here.
  bool put(T item) {
    slots_[writer_] = std::move(item);
    const std::uint32_t middle = middle_.exchange(writer_ | kFull, std::memory_order_acq_rel);
    writer_ = middle & kIndex;
    slots_[writer_] = T{};
    const bool replaced = (middle & kFull) != 0;
    if (replaced) replaced_.store(replaced_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    return replaced;
  }

  /// Reader. The newest item put since the last take.
  [[nodiscard]] std::optional<T> take() {
    if ((middle_.load(std::memory_order_relaxed) & kFull) == 0) return std::nullopt;
    reader_ = middle_.exchange(reader_, std::memory_order_acq_rel) & kIndex;
    return std::exchange(slots_[reader_], T{});
  }

  /// Any thread.
  [[nodiscard]] bool full() const noexcept { return (middle_.load(std::memory_order_acquire) & kFull) != 0; }
  [[nodiscard]] std::uint64_t replaced() const noexcept { return replaced_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::uint32_t kIndex = 3;
  static constexpr std::uint32_t kFull = 4;

  std::array<T, 3> slots_{};
  alignas(kCacheLine) std::atomic<std::uint32_t> middle_{1};
  std::atomic<std::uint64_t> replaced_{0};
  alignas(kCacheLine) std::uint32_t writer_ = 0;
  alignas(kCacheLine) std::uint32_t reader_ = 2;
};

}  // namespace enamel
