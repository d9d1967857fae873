// Hands out ranges of one big buffer: first fit, neighbours merge when freed, the buffer doubles when full.
#pragma once

#include <cstddef>
#include <map>

namespace enamel::view {

struct Slot {
  std::size_t offset = 0;
  std::size_t size = 0;
};

/// Not thread-safe. Sizes are in elements of whatever the buffer holds.
class SlotArena {
 public:
  explicit SlotArena(std::size_t initial_capacity = 1024);

  /// size >= 1. May raise capacity(): the owner then copies the buffer into a larger one.
  [[nodiscard]] Slot allocate(std::size_t size);
  void release(const Slot& slot);

  [[nodiscard]] std::size_t capacity() const noexcept { return capacity_; }
  [[nodiscard]] std::size_t used() const noexcept { return used_; }  ///< sum of the sizes handed out
  [[nodiscard]] std::size_t end() const noexcept;                    ///< behind the last slot in use

 private:
  void give_back(const Slot& slot);

  std::size_t capacity_;
  std::size_t used_ = 0;
  std::map<std::size_t, std::size_t> free_;  ///< offset -> size
};

}  // namespace enamel::view
