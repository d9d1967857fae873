// Choices drawn from a fuzzer's bytes; zeros once they run out, so that every input means something.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace enamel::test {

class ByteSource {
 public:
  ByteSource(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  std::uint8_t byte() { return at_ < size_ ? data_[at_++] : 0; }
  /// 0 … n-1; n > 0.
  std::size_t below(std::size_t n) {
    const std::size_t high = byte();
    return (high * 256 + byte()) % n;
  }
  bool one_in(std::size_t n) { return below(n) == n - 1; }
  template <class T>
  T number() {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) value |= std::uint64_t{byte()} << (8 * i);
    return static_cast<T>(value);
  }
  [[nodiscard]] bool empty() const { return at_ >= size_; }
  [[nodiscard]] std::span<const std::byte> rest() const { return std::as_bytes(std::span(data_, size_).subspan(at_)); }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t at_ = 0;
};

}  // namespace enamel::test
