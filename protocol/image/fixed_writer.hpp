// Little-endian writer into memory of fixed size: ByteWriter without the heap.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "protocol/base/bytes.hpp"

namespace enamel::image {

/// What does not fit is left out: sizes are constants, and reading back what was written shows it.
class FixedWriter {
 public:
  explicit FixedWriter(std::span<std::byte> out) noexcept : rest_(out) {}

  template <WireScalar T>
  void put(T value) noexcept {
    put_bytes(std::as_bytes(std::span<const T>(&value, 1)));
  }
  void put_bytes(std::span<const std::byte> bytes) noexcept {
    if (bytes.size() > rest_.size()) return;
    std::copy(bytes.begin(), bytes.end(), rest_.begin());
    rest_ = rest_.subspan(bytes.size());
  }
  template <std::size_t N>
  void put_array(const std::array<std::uint8_t, N>& bytes) noexcept {
    put_bytes(std::as_bytes(std::span(bytes)));
  }

 private:
  std::span<std::byte> rest_;
};

}  // namespace enamel::image
