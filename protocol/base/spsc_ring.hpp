// Bounded queue between exactly one producer and one consumer. Neither side ever waits for the other.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "protocol/base/cache_line.hpp"
#include "protocol/base/check.hpp"

namespace enamel {

/// Lamport queue with cached indices (each side re-reads the other's index only when the cached one says full or
/// empty). One thread may push and one other may pop at a time; roles may move to another thread with a happens-before
/// edge. Slots hold default-constructed values; a popped slot is reset so that it keeps nothing alive.
template <class T>
class SpscRing {
 public:
  /// Holds at most `capacity` items, at least 1.
  explicit SpscRing(std::size_t capacity) : capacity_(capacity), mask_(std::bit_ceil(capacity) - 1), slots_(mask_ + 1) {
    ENAMEL_CHECK(capacity > 0);
  }
  SpscRing(const SpscRing&) = delete;
  SpscRing& operator=(const SpscRing&) = delete;

  [[nodiscard]] std::size_t capacity() const noexcept { return capacity_; }

  /// Producer. False when full; then `item` is untouched.
  [[nodiscard]] bool push(T&& item) {
    if (!writable()) return false;
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    slots_[tail & mask_] = std::move(item);
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }
  [[nodiscard]] bool push(const T& item) { return push(T(item)); }

  /// Producer. True stays true until the next push.
  [[nodiscard]] bool writable() noexcept {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail - head_seen_ < capacity_) return true;
    head_seen_ = head_.load(std::memory_order_acquire);
    return tail - head_seen_ < capacity_;
  }

  /// Consumer. The oldest item in place, null when empty; stays valid until pop().
  [[nodiscard]] T* front() noexcept {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_seen_) {
      tail_seen_ = tail_.load(std::memory_order_acquire);
      if (head == tail_seen_) return nullptr;
    }
    return &slots_[head & mask_];
  }

  /// Consumer, after front() gave an item.
  void pop() {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    slots_[head & mask_] = T{};
    head_.store(head + 1, std::memory_order_release);
  }

  /// Any thread; exact only when both sides rest.
  [[nodiscard]] std::size_t size() const noexcept {
    const std::size_t head = head_.load(std::memory_order_acquire);
    const std::size_t tail = tail_.load(std::memory_order_acquire);
    return std::min(tail - head, capacity_);
  }

 private:
  const std::size_t capacity_;
  const std::size_t mask_;
  std::vector<T> slots_;
  alignas(kCacheLine) std::atomic<std::size_t> tail_{0};
  std::size_t head_seen_ = 0;  // producer's copy
  alignas(kCacheLine) std::atomic<std::size_t> head_{0};
  std::size_t tail_seen_ = 0;  // consumer's copy
};

}  // namespace enamel
