// Manifest of a firmware image (docs/firmware-image.md §1): structure only; whom to trust is in trust.hpp.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "protocol/base/bytes.hpp"
#include "protocol/base/sha256.hpp"
#include "protocol/image/refusal.hpp"

namespace enamel::image {

inline constexpr std::array<std::uint8_t, 8> kImageMagic = {0x45, 0x4E, 0x4D, 0x46, 0x57, 0x0D, 0x0A, 0x1A};
inline constexpr std::size_t kHeaderSize = 128;
inline constexpr std::size_t kManifestStep = 4096;
inline constexpr std::size_t kMaxManifest = 65536;
inline constexpr std::size_t kChunkSize = 65536;
inline constexpr std::uint64_t kMaxPayload = 16ULL << 20U;
inline constexpr std::uint32_t kProductId = 0x324D4E45;  ///< "ENM2"
inline constexpr std::size_t kSignatureEntry = 16 + 64;
inline constexpr std::size_t kMaxSignatures = 2;

struct ImageVersion {
  std::uint8_t major = 0;
  std::uint8_t minor = 0;
  std::uint16_t revision = 0;
  std::uint32_t build = 0;
  // NOLINTNEXTLINE(modernize-use-nullptr): clang-tidy 14 takes the rewritten "<=> 0" for a null pointer
  friend auto operator<=>(const ImageVersion&, const ImageVersion&) = default;
};

[[nodiscard]] inline ImageVersion read_version(ByteReader& in) noexcept {
  ImageVersion v;
  v.major = in.get<std::uint8_t>();
  v.minor = in.get<std::uint8_t>();
  v.revision = in.get<std::uint16_t>();
  v.build = in.get<std::uint32_t>();
  return v;
}

/// `out`: ByteWriter or FixedWriter.
template <class Writer>
void put_version(Writer& out, const ImageVersion& v) {
  out.put(v.major);
  out.put(v.minor);
  out.put(v.revision);
  out.put(v.build);
}

using KeyId = std::array<std::uint8_t, 16>;
using SignatureBytes = std::array<std::uint8_t, 64>;

namespace image_flags {
inline constexpr std::uint32_t kFull = 1U << 0U;
inline constexpr std::uint32_t kEncrypted = 1U << 1U;
inline constexpr std::uint32_t kFactoryOnly = 1U << 2U;
inline constexpr std::uint32_t kDevelopment = 1U << 3U;
inline constexpr std::uint32_t kUsable = kFull | kFactoryOnly | kDevelopment;  ///< encrypted images are reserved
}  // namespace image_flags

namespace tlv {
inline constexpr std::uint16_t kSecurityCounter = 0x0050;
inline constexpr std::uint16_t kComponent = 0x00A0;
inline constexpr std::uint16_t kGitCommit = 0x00A1;
inline constexpr std::uint16_t kMinBootloader = 0x00A2;
inline constexpr std::uint16_t kProtocolRange = 0x00A3;
inline constexpr std::uint16_t kNotes = 0x00A4;
inline constexpr std::uint16_t kBillOfMaterials = 0x00A5;
}  // namespace tlv

struct ProtocolRange {
  std::uint16_t lowest = 0;
  std::uint16_t highest = 0;
};

/// A part of the payload. Kinds: docs/firmware-image.md §1.
struct Component {
  std::uint8_t kind = 0;
  std::uint8_t slot = 0;
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  Sha256Digest sha256{};
};

/// Views into the bytes that were parsed, which must outlive it.
struct Manifest {
  std::uint32_t manifest_len = 0;
  std::uint64_t payload_len = 0;
  std::uint32_t chunk_count = 0;
  std::uint32_t product_id = 0;
  std::uint16_t hw_rev_min = 0;
  std::uint16_t hw_rev_max = 0;
  ImageVersion version;
  std::uint32_t security_counter = 0;
  std::uint32_t flags = 0;
  std::uint64_t build_time_unix_s = 0;
  KeyId key_id{};
  std::optional<ImageVersion> min_bootloader;
  std::optional<ProtocolRange> protocol;
  std::uint16_t signature_count = 0;

  std::span<const std::byte> bytes;        ///< all of it, manifest_len
  std::span<const std::byte> tlvs;         ///< checked: they follow each other without a rest
  std::span<const std::byte> chunk_table;  ///< chunk_count digests
  std::span<const std::byte> signed_part;  ///< what the signatures cover, after the prefix
  std::span<const std::byte> signatures;   ///< signature_count entries of kSignatureEntry

  [[nodiscard]] std::uint64_t image_len() const noexcept { return manifest_len + payload_len; }
  /// Bytes of chunk i < chunk_count: kChunkSize, or what is left for the last one.
  [[nodiscard]] std::size_t chunk_length(std::uint32_t i) const noexcept;
  [[nodiscard]] Sha256Digest chunk_digest(std::uint32_t i) const noexcept;
  [[nodiscard]] KeyId signer(std::size_t i) const noexcept;
  [[nodiscard]] SignatureBytes signature(std::size_t i) const noexcept;
};

/// Length that the header states, from the first kHeaderSize bytes, so that a receiver knows how much to gather.
/// kMagic (or kDfuSe) when they are no header.
[[nodiscard]] Checked<std::uint32_t> manifest_length(std::span<const std::byte> header) noexcept;

/// Parses the manifest at the start of `image` (what follows it is not looked at): every field, length and digest of
/// itself, the pad. kTruncated when `image` is shorter than the manifest. Identity of the manifest: its SHA-256.
[[nodiscard]] Checked<Manifest> parse_manifest(std::span<const std::byte> image) noexcept;

/// Calls visit(type, value) for each TLV of a parsed manifest.
template <class Visit>
void for_each_tlv(const Manifest& manifest, Visit&& visit) {
  ByteReader in(manifest.tlvs);
  while (in.ok() && in.remaining() > 0) {
    const auto type = in.get<std::uint16_t>();
    const auto length = in.get<std::uint16_t>();
    const std::span<const std::byte> value = in.take(length);
    if (in.ok()) visit(type, value);
  }
}

/// A component TLV's value; nothing when it is no component.
[[nodiscard]] std::optional<Component> parse_component(std::span<const std::byte> value) noexcept;

}  // namespace enamel::image
