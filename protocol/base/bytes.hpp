// Bounds-checked little-endian reader and writer for file formats and wire messages.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace enamel {

static_assert(std::endian::native == std::endian::little, "ByteReader and ByteWriter copy little-endian memory");

/// Types that may be copied from foreign bytes: any bit pattern is a value (so no bool and no enum).
template <class T>
concept WireScalar =
    (std::is_integral_v<T> && !std::is_same_v<std::remove_cv_t<T>, bool>) || std::is_floating_point_v<T>;

/// Reads from a span that must outlive it. The first read past the end fails, and every read after it: values become 0,
/// spans empty. Check ok() once at the end (and before using a length as a loop bound).
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) noexcept : bytes_(bytes) {}

  [[nodiscard]] bool ok() const noexcept { return ok_; }
  [[nodiscard]] std::size_t position() const noexcept { return pos_; }
  [[nodiscard]] std::size_t remaining() const noexcept { return bytes_.size() - pos_; }

  template <WireScalar T>
  [[nodiscard]] T get() noexcept {
    T value{};
    const std::span<const std::byte> b = take(sizeof(T));
    if (b.size() == sizeof(T)) std::memcpy(&value, b.data(), sizeof(T));
    return value;
  }
  /// View of the next n bytes.
  [[nodiscard]] std::span<const std::byte> take(std::size_t n) noexcept {
    if (!ok_ || n > remaining()) {
      ok_ = false;
      return {};
    }
    const std::span<const std::byte> out = bytes_.subspan(pos_, n);
    pos_ += n;
    return out;
  }
  [[nodiscard]] std::string_view take_text(std::size_t n) noexcept {
    const std::span<const std::byte> b = take(n);
    return {reinterpret_cast<const char*>(b.data()), b.size()};
  }
  void skip(std::size_t n) noexcept { static_cast<void>(take(n)); }
  /// Skips padding up to a multiple of `alignment` counted from `origin`.
  void align(std::size_t alignment, std::size_t origin = 0) noexcept {
    const std::size_t past = (pos_ - origin) % alignment;
    if (past != 0) skip(alignment - past);
  }
  /// Declares what was read unusable (a bad magic number, a length out of range).
  void invalidate() noexcept { ok_ = false; }

 private:
  std::span<const std::byte> bytes_;
  std::size_t pos_ = 0;
  bool ok_ = true;
};

/// Appends to a vector that it owns.
class ByteWriter {
 public:
  [[nodiscard]] std::size_t size() const noexcept { return out_.size(); }
  [[nodiscard]] std::span<const std::byte> bytes() const noexcept { return out_; }
  [[nodiscard]] std::vector<std::byte> release() noexcept { return std::move(out_); }
  void clear() noexcept { out_.clear(); }

  template <WireScalar T>
  void put(T value) {
    put_bytes(std::as_bytes(std::span<const T>(&value, 1)));
  }
  // Not inlined: g++ 12 sees overflows in the vector's inlined growth that are not there.
  [[gnu::noinline]] void put_bytes(std::span<const std::byte> b) { out_.insert(out_.end(), b.begin(), b.end()); }
  void put_text(std::string_view text) { put_bytes(std::as_bytes(std::span(text.data(), text.size()))); }
  void align(std::size_t alignment, std::size_t origin = 0) {
    while ((out_.size() - origin) % alignment != 0) out_.push_back(std::byte{0});
  }
  /// Overwrites a value put before at `position` (a length known only later). False when it does not lie inside.
  template <WireScalar T>
  [[nodiscard]] bool patch(std::size_t position, T value) noexcept {
    if (position > out_.size() || sizeof(T) > out_.size() - position) return false;
    std::memcpy(out_.data() + position, &value, sizeof(T));
    return true;
  }

 private:
  std::vector<std::byte> out_;
};

}  // namespace enamel
