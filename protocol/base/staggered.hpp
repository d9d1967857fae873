// Memory of images. Loops read and write a dozen images side by side, and one of 640 x 480 floats is 300 pages of 4 KiB
// exactly: allocated one after the other, the same pixel of all of them would fall into the same set of the first-level
// cache, and loads would wait for stores to other images whose addresses end alike.
#pragma once

#include <atomic>
#include <cstddef>
#include <limits>
#include <new>
#include <utility>
#include <vector>

#include "protocol/base/image_blocks.hpp"

namespace enamel {

namespace detail {
inline std::atomic<std::size_t> images{0};  ///< allocated so far, of all types
}

/// Blocks of a page and more begin at another place within a page each time; what they hold does not depend on it.
/// Large ones are used again (image_blocks.hpp). A vector of elements without a value does not clear them. Thread-safe.
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
    const std::size_t bytes = block_bytes(n);
    auto* block = is_kept(bytes) ? take_image_block(bytes) : static_cast<std::byte*>(::operator new(bytes, kWholePage));
    std::byte* data = block + kHead + place;
    ::new (data - sizeof(std::size_t)) std::size_t(place);
    return reinterpret_cast<T*>(data);
  }

  void deallocate(T* data, std::size_t n) noexcept {
    if (!is_image(n)) return ::operator delete(data, kLine);
    auto* bytes = reinterpret_cast<std::byte*>(data);
    const std::size_t place = *reinterpret_cast<const std::size_t*>(bytes - sizeof(std::size_t));
    std::byte* block = bytes - place - kHead;
    if (is_kept(block_bytes(n))) return give_image_block(block, block_bytes(n));
    ::operator delete(block, kWholePage);
  }

  /// Without arguments an element has no value yet: whoever makes an image so writes all of it.
  template <class U, class... Args>
  void construct(U* at, Args&&... args) {
    if constexpr (sizeof...(Args) == 0) {
      ::new (static_cast<void*>(at)) U;
    } else {
      ::new (static_cast<void*>(at)) U(std::forward<Args>(args)...);
    }
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

  static constexpr std::size_t kLeastKept = std::size_t{1}
                                            << 16U;  ///< chosen: by judgement; the heap keeps smaller ones

  /// Room for any place, in whole pages: images of one size are alike to image_blocks.hpp whatever they hold.
  static std::size_t block_bytes(std::size_t n) noexcept {
    return (n * sizeof(T) + kHead + 2 * kPage - 1) / kPage * kPage;
  }
  static bool is_kept(std::size_t bytes) noexcept { return bytes >= kLeastKept; }
  static bool is_image(std::size_t n) noexcept { return n * sizeof(T) >= kPage; }
  static std::size_t next_place() noexcept { return detail::images.fetch_add(1, std::memory_order_relaxed) % kPlaces; }
};

template <class T>
using StaggeredVector = std::vector<T, Staggered<T>>;

}  // namespace enamel
