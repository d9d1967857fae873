// Whether what lies in a slot may boot: signature of its manifest and every chunk, read from the flash.
#pragma once

#include <array>

#include "firmware/boot/flash_map.hpp"
#include "protocol/image/trust.hpp"

namespace enamel::fw {

/// Memory for one check, kept by the caller: a bootloader has no heap.
struct SlotWorkspace {
  std::array<std::byte, image::kMaxManifest> manifest;
  std::array<std::byte, 4096> piece;
};

/// SHA-256 of `length` bytes from `offset`; zero digest when they cannot be read.
[[nodiscard]] Sha256Digest hash_region(const FlashRegion& region, std::uint64_t offset, std::uint64_t length,
                                       std::span<std::byte> piece) noexcept;

/// The manifest in a slot, checked for structure, hardware and signature. Views into `workspace.manifest`. Neither
/// counter nor revocation is looked at: what was good enough to be confirmed must not stop to boot.
[[nodiscard]] image::Checked<image::Manifest> read_slot_manifest(const FlashRegion& slot,
                                                                 const image::Hardware& hardware, image::Trust trust,
                                                                 SlotWorkspace& workspace) noexcept;

/// A chunk of the payload, below manifest.chunk_count, has its digest.
[[nodiscard]] bool chunk_verifies(const FlashRegion& slot, const image::Manifest& manifest, std::uint32_t chunk,
                                  SlotWorkspace& workspace) noexcept;

/// As read_slot_manifest(), and every chunk has its digest (kChunkHash).
[[nodiscard]] image::Checked<image::Manifest> check_slot(const FlashRegion& slot, const image::Hardware& hardware,
                                                         const image::Trust& trust, SlotWorkspace& workspace) noexcept;

}  // namespace enamel::fw
