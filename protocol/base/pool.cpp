#include "protocol/base/pool.hpp"

#include <algorithm>
#include <bit>

namespace enamel {

// A queue of one cell could not tell full from empty, hence at least two.
IndexQueue::IndexQueue(std::size_t capacity)
    : cells_(std::bit_ceil(std::max<std::size_t>(capacity, 2))), mask_(cells_.size() - 1) {
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    cells_[i].sequence.store(i, std::memory_order_relaxed);
    cells_[i].index = 0;
  }
}

bool IndexQueue::push(std::uint32_t index) noexcept {
  std::size_t tail = tail_.load(std::memory_order_relaxed);
  while (true) {
    Cell& cell = cells_[tail & mask_];
    const std::size_t sequence = cell.sequence.load(std::memory_order_acquire);
    if (sequence == tail) {
      if (tail_.compare_exchange_weak(tail, tail + 1, std::memory_order_relaxed)) {
        cell.index = index;
        cell.sequence.store(tail + 1, std::memory_order_release);
        return true;
      }
    } else if (static_cast<std::ptrdiff_t>(sequence - tail) < 0) {
      return false;
    } else {
      tail = tail_.load(std::memory_order_relaxed);
    }
  }
}

bool IndexQueue::pop(std::uint32_t& index) noexcept {
  std::size_t head = head_.load(std::memory_order_relaxed);
  while (true) {
    Cell& cell = cells_[head & mask_];
    const std::size_t sequence = cell.sequence.load(std::memory_order_acquire);
    if (sequence == head + 1) {
      if (head_.compare_exchange_weak(head, head + 1, std::memory_order_relaxed)) {
        index = cell.index;
        cell.sequence.store(head + mask_ + 1, std::memory_order_release);
        return true;
      }
    } else if (static_cast<std::ptrdiff_t>(sequence - (head + 1)) < 0) {
      return false;
    } else {
      head = head_.load(std::memory_order_relaxed);
    }
  }
}

}  // namespace enamel
