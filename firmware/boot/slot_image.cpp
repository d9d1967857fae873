#include "firmware/boot/slot_image.hpp"

#include <algorithm>

namespace enamel::fw {

Sha256Digest hash_region(const FlashRegion& region, std::uint64_t offset, std::uint64_t length,
                         std::span<std::byte> piece) noexcept {
  RollingHash hash;
  while (length > 0) {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(length, piece.size()));
    if (region.read(offset, piece.first(n)) != FlashStatus::kOk) return {};
    hash.update(piece.first(n));
    offset += n;
    length -= n;
  }
  return hash.digest();
}

image::Checked<image::Manifest> read_slot_manifest(const FlashRegion& slot, const image::Hardware& hardware,
                                                   image::Trust trust, SlotWorkspace& workspace) noexcept {
  if (slot.read(0, workspace.manifest) != FlashStatus::kOk) return image::refuse(image::Refusal::kFlashWrite);
  const image::Checked<image::Manifest> manifest = image::parse_manifest(workspace.manifest);
  if (!manifest) return image::refuse(manifest.error());
  trust.revoked = 0;
  ENAMEL_CHECK_THAT(image::check_hardware(*manifest, hardware));
  ENAMEL_CHECK_THAT(image::check_signatures(*manifest, trust));
  return manifest;
}

bool chunk_verifies(const FlashRegion& slot, const image::Manifest& manifest, std::uint32_t chunk,
                    SlotWorkspace& workspace) noexcept {
  const std::uint64_t at = flash_map::kManifestArea + std::uint64_t{chunk} * image::kChunkSize;
  return hash_region(slot, at, manifest.chunk_length(chunk), workspace.piece) == manifest.chunk_digest(chunk);
}

image::Checked<image::Manifest> check_slot(const FlashRegion& slot, const image::Hardware& hardware,
                                           const image::Trust& trust, SlotWorkspace& workspace) noexcept {
  const image::Checked<image::Manifest> manifest = read_slot_manifest(slot, hardware, trust, workspace);
  if (!manifest) return manifest;
  for (std::uint32_t i = 0; i < manifest->chunk_count; ++i) {
    if (!chunk_verifies(slot, *manifest, i, workspace)) return image::refuse(image::Refusal::kChunkHash);
  }
  return manifest;
}

}  // namespace enamel::fw
