// 64-bit digests of stage outputs: length and CRC-32 of the bytes. They tell runs apart (every single flipped bit
// shows), they do not defend against malice. NaN is compared by its bits.
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "pipeline/types/geometry.hpp"
#include "pipeline/types/map.hpp"
#include "protocol/base/crc32.hpp"

namespace enamel::stage {

class Digest {
 public:
  template <class T>
  requires std::is_trivially_copyable_v<T> Digest& add(std::span<const T> values) noexcept {
    low_ = crc32(std::as_bytes(values), low_);
    length_ += values.size_bytes();
    return *this;
  }
  template <class T>
  requires std::is_arithmetic_v<T> Digest& add(T value) noexcept { return add(std::span<const T>(&value, 1)); }
  Digest& add(const Map<float>& map) noexcept { return add(map.pixels()); }
  Digest& add(const Map<Vec3f>& map) noexcept {
    return add(std::span<const float>(reinterpret_cast<const float*>(map.pixels().data()), map.size() * 3));
  }
  Digest& add(const Pose& pose) noexcept { return add(std::span<const double>(pose.data(), 16)); }

  [[nodiscard]] std::uint64_t value() const noexcept { return (length_ << 32U) ^ low_; }

 private:
  std::uint32_t low_ = 0;
  std::uint64_t length_ = 0;
};

}  // namespace enamel::stage
