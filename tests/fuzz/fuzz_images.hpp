// Images that fuzz targets start from, and repair of what their edits broke so that the checks behind are reached.
#pragma once

#include <vector>

#include "protocol/image/dfu_suffix.hpp"
#include "tests/fuzz/byte_source.hpp"
#include "tests/support/firmware_image.hpp"

namespace enamel::test {

using Bytes = std::vector<std::byte>;

/// `file` without its DFU suffix: what a probe gets.
[[nodiscard]] inline Bytes as_sent(Bytes file) {
  file.resize(file.size() - image::kSuffixSize);
  return file;
}

[[nodiscard]] inline Bytes make_image(image::ImageVersion version, std::uint32_t counter, std::size_t payload,
                                      std::span<const image::Signer> signers,
                                      std::uint32_t flags = image::image_flags::kFull) {
  image::ImageDescription d = plain_description();
  d.version = version;
  d.security_counter = counter;
  d.flags = flags;
  d.components = {{1, 0, 0, payload / 2, {}}, {5, 0, payload / 2, payload - payload / 2, {}}};
  return build(d, random_payload(payload, version.major), signers);
}

/// Overwrites a few places of `bytes` as the input says; half of them near its start, where the header lies.
inline void edit(Bytes& bytes, ByteSource& in, std::size_t edits) {
  for (; edits > 0 && !bytes.empty(); --edits) {
    const std::size_t reach = in.one_in(2) ? bytes.size() : std::min<std::size_t>(bytes.size(), 320);
    const std::size_t at = in.number<std::uint32_t>() % reach;
    for (std::size_t i = at, n = 1 + in.below(8); i < bytes.size() && n > 0; ++i, --n) {
      bytes[i] = static_cast<std::byte>(in.byte());
    }
  }
}

/// Makes digest of the table and CRC of the header fit what they cover; with a signer, the first signature too.
void repair(Bytes& image, const image::Signer* signer);

}  // namespace enamel::test
