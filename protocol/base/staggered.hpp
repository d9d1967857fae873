// Memory of images. Loops read and write a dozen images side by side, and one of 640 x 480 floats is 300 pages of 4 KiB
// exactly: allocated one after the other, the same pixel of all of them would fall into the same set of the first-level
// cache, and loads would wait for stores to other images whose addresses end alike.
#pragma once

#include <atomic>
#include <cstddef>
#include <limits>
#include <new>
#include <vector>

namespace enamel {

namespace detail {
inline std::atomic<std::size_t> images{0};  ///< allocated so far, of all types
}

/// Blocks of a page and more begin at another place within a page each time; what they hold does not depend on it.
/// Thread-safe.
template <class T>
class Staggered {
 public:
  using value_type = T;

  Staggered() = default;
  template <class Other>
  Staggered(const Staggered<Other>&) noexcept {}  // NOLINT(google-explicit-constructor): required of allocators

  [[nodiscard]] T* allocate(std::size_t n) {
    if (n > (std::numeric_limits<std::size_t>::max() - 2 * kPage) / sizeof(T)) throw std::bad_array_new_length();
    if (!is_image(n)) return static_cast<T*>(::operator new(n * sizeof(T), kLine));
    // A block that begins with a page: where the image begins does not depend on what else the heap holds.
    const std::size_t place = next_place() * kStep;
    auto* block = static_cast<std::byte*>(::operator new(n * sizeof(T) + kHead + place, kWholePage));
    std::byte* data = block + kHead + place;
    ::new (data - sizeof(std::size_t)) std::size_t(place);
    return reinterpret_cast<T*>(data);
  }

  void deallocate(T* data, std::size_t n) noexcept {
    if (!is_image(n)) return ::operator delete(data, kLine);
    auto* bytes = reinterpret_cast<std::byte*>(data);
    const std::size_t place = *reinterpret_cast<const std::size_t*>(bytes - sizeof(std::size_t));
    ::operator delete(bytes - place - kHead, kWholePage);
  }

  template <class Other>
  bool operator==(const Staggered<Other>&) const noexcept {
    return true;
  }

 private:
  static constexpr std::size_t kPage = 4096, kPlaces = 16, kStep = kPage / kPlaces;
  static constexpr std::size_t kHead = 64;  ///< a cache line, in which the place is kept
  static constexpr std::align_val_t kLine{kHead}, kWholePage{kPage};
  static_assert(alignof(T) <= kHead);

  static bool is_image(std::size_t n) noexcept { return n * sizeof(T) >= kPage; }
  static std::size_t next_place() noexcept { return detail::images.fetch_add(1, std::memory_order_relaxed) % kPlaces; }
};

template <class T>
using StaggeredVector = std::vector<T, Staggered<T>>;

}  // namespace enamel
