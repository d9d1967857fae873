#include "protocol/image/image_file.hpp"

#include "protocol/image/dfu_suffix.hpp"

namespace enamel::image {

Checked<Manifest> open_image(std::span<const std::byte> file) {
  const Checked<Manifest> manifest = parse_manifest(file);
  if (!manifest) return manifest;
  const Checked<DfuSuffix> suffix = read_suffix(file);
  if (!suffix) return refuse(suffix.error());
  if (file.size() != manifest->image_len() + kSuffixSize) return refuse(Refusal::kTruncated);
  return manifest;
}

Checked<Manifest> check_image_file(std::span<const std::byte> file, std::span<const TrustedKey> keys) {
  const Checked<Manifest> manifest = open_image(file);
  if (!manifest) return manifest;
  const std::span<const std::byte> payload = file.subspan(manifest->manifest_len);
  for (std::uint32_t i = 0; i < manifest->chunk_count; ++i) {
    const auto chunk = payload.subspan(std::size_t{i} * kChunkSize, manifest->chunk_length(i));
    if (sha256(chunk) != manifest->chunk_digest(i)) return refuse(Refusal::kChunkHash);
  }
  if (keys.empty()) return manifest;
  if (const auto good = check_signatures(*manifest, {keys, 0, true, &sodium_ed25519()}); !good) {
    return refuse(good.error());
  }
  return manifest;
}

}  // namespace enamel::image
