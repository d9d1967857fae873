// Values made when they are asked for; those asked for last stay in memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace enamel {

/// Thread-safe. What it gives never depends on who asked before, for `make` is a pure function: it is called by whoever
/// asks, and again where the value was dropped since.
template <class T>
class Recent {
 public:
  using Make = std::function<T(std::size_t)>;
  Recent(std::size_t count, std::size_t most_kept, Make make)
      : make_(std::move(make)), most_kept_(std::max<std::size_t>(most_kept, 1)), slots_(count) {}

  /// The value stays as long as the pointer lives. Precondition: k < size().
  [[nodiscard]] std::shared_ptr<const T> get(std::size_t k) const {
    {
      const std::lock_guard lock(mutex_);
      slots_[k].asked = ++questions_;
      if (slots_[k].value) return slots_[k].value;
    }
    // Not under the lock: two threads may make the same at the same time, and both get the first.
    auto made = std::make_shared<const T>(make_(k));
    const std::lock_guard lock(mutex_);
    if (slots_[k].value) return slots_[k].value;
    if (kept_ == most_kept_) drop_oldest();
    ++kept_;
    slots_[k].value = made;
    return made;
  }
  [[nodiscard]] std::size_t size() const noexcept { return slots_.size(); }
  [[nodiscard]] std::size_t most_kept() const noexcept { return most_kept_; }

 private:
  struct Slot {
    std::shared_ptr<const T> value;
    std::uint64_t asked = 0;  ///< serial number of the last question
  };
  void drop_oldest() const {
    Slot* oldest = nullptr;
    for (Slot& slot : slots_) {
      if (slot.value && (oldest == nullptr || slot.asked < oldest->asked)) oldest = &slot;
    }
    oldest->value = nullptr;
    --kept_;
  }

  Make make_;
  std::size_t most_kept_;
  mutable std::mutex mutex_;  // guards what follows
  mutable std::vector<Slot> slots_;
  mutable std::size_t kept_ = 0;
  mutable std::uint64_t questions_ = 0;
};

}  // namespace enamel
