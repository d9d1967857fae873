// SHA-256: identity of files, calibrations and stage outputs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace enamel {

using Sha256Digest = std::array<std::uint8_t, 32>;

/// Lower-case hexadecimal.
[[nodiscard]] std::string to_hex(std::span<const std::uint8_t> bytes);

/// SHA-256 of a stream of bytes that can be read at any point without ending it. Copyable; not thread-safe.
class RollingHash {
 public:
  RollingHash() noexcept;
  RollingHash& update(std::span<const std::byte> bytes) noexcept;
  RollingHash& update(std::string_view text) noexcept { return update(std::as_bytes(std::span<const char>(text))); }
  /// Bytes of contiguous values as they lie in memory. Only for types without padding.
  template <class T>
  requires(std::has_unique_object_representations_v<T> ||
           std::is_floating_point_v<T>) RollingHash& update_values(std::span<const T> values) noexcept {
    return update(std::as_bytes(values));
  }
  template <class T>
  requires(std::has_unique_object_representations_v<T> ||
           std::is_floating_point_v<T>) RollingHash& update_value(const T& value) noexcept {
    return update(std::as_bytes(std::span<const T>(&value, 1)));
  }
  /// Digest of everything so far; the stream goes on.
  [[nodiscard]] Sha256Digest digest() const noexcept;
  [[nodiscard]] std::string hex() const { return to_hex(digest()); }

 private:
  alignas(8) std::array<std::byte, 128> state_{};
};

[[nodiscard]] inline Sha256Digest sha256(std::span<const std::byte> bytes) noexcept {
  return RollingHash().update(bytes).digest();
}
[[nodiscard]] std::string sha256_hex(std::span<const std::byte> bytes);

}  // namespace enamel
