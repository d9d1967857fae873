// Choices drawn from a fuzzer's bytes; zeros once they run out, so that every input means something.
#pragma once

#include <cstddef>
#include <cstdint>

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

 private:
  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t at_ = 0;
};

}  // namespace enamel::test
