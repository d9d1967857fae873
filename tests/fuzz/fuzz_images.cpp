#include "tests/fuzz/fuzz_images.hpp"

#include <algorithm>
#include <cstring>

#include "protocol/base/crc32.hpp"

namespace enamel::test {
namespace {

constexpr std::size_t kCountAt = 28, kDigestAt = 64, kTableAt = 116, kSignaturesAt = 120, kCrcAt = 124;

template <class T>
T get(const Bytes& bytes, std::size_t at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

template <class T>
void put(Bytes& bytes, std::size_t at, const T& value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

}  // namespace

void repair(Bytes& image, const image::Signer* signer) {
  if (image.size() < image::kHeaderSize) return;
  const std::size_t table = get<std::uint32_t>(image, kTableAt), length = 32ULL * get<std::uint32_t>(image, kCountAt);
  if (table <= image.size() && length <= image.size() - table) {
    put(image, kDigestAt, sha256(std::span(image).subspan(table, length)));
  }
  put(image, kCrcAt, crc32(std::span(image).first(kCrcAt)));
  const std::size_t signatures = get<std::uint32_t>(image, kSignaturesAt);
  if (signer == nullptr || image.size() < 4 + image::kSignatureEntry ||
      signatures > image.size() - 4 - image::kSignatureEntry) {
    return;
  }
  const std::size_t first = signatures + 4 + sizeof(image::KeyId);
  put(image, first, signer->sign(std::span(image).first(signatures)));
}

}  // namespace enamel::test
