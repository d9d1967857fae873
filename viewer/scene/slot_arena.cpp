#include "viewer/scene/slot_arena.hpp"

#include <algorithm>
#include <iterator>

namespace enamel::view {

SlotArena::SlotArena(std::size_t initial_capacity) : capacity_(std::max<std::size_t>(initial_capacity, 1)) {
  free_.emplace(0, capacity_);
}

Slot SlotArena::allocate(std::size_t size) {
  size = std::max<std::size_t>(size, 1);
  auto hole = std::find_if(free_.begin(), free_.end(), [size](const auto& entry) { return entry.second >= size; });
  if (hole == free_.end()) {
    const std::size_t old_capacity = capacity_;
    while (capacity_ - old_capacity < size) {
      capacity_ *= 2;
    }
    give_back({old_capacity, capacity_ - old_capacity});
    hole = std::prev(free_.end());
  }
  const Slot slot{hole->first, size};
  const std::size_t rest = hole->second - size;
  free_.erase(hole);
  if (rest > 0) {
    free_.emplace(slot.offset + size, rest);
  }
  used_ += size;
  return slot;
}

void SlotArena::release(const Slot& slot) {
  if (slot.size > 0) {
    used_ -= slot.size;
    give_back(slot);
  }
}

void SlotArena::give_back(const Slot& slot) {
  auto at = free_.emplace(slot.offset, slot.size).first;
  const auto after = std::next(at);
  if (after != free_.end() && at->first + at->second == after->first) {
    at->second += after->second;
    free_.erase(after);
  }
  if (at != free_.begin()) {
    const auto before = std::prev(at);
    if (before->first + before->second == at->first) {
      before->second += at->second;
      free_.erase(at);
    }
  }
}

std::size_t SlotArena::end() const noexcept {
  if (free_.empty()) {
    return capacity_;
  }
  const auto& last = *free_.rbegin();
  return last.first + last.second == capacity_ ? last.first : capacity_;
}

}  // namespace enamel::view
