#include "protocol/image/manifest.hpp"

#include <algorithm>
#include <cstring>

#include "protocol/base/crc32.hpp"

namespace enamel::image {
namespace {

constexpr std::uint16_t kHeaderVersion = 1;
constexpr std::uint16_t kAlgorithmEd25519 = 1;
constexpr std::uint8_t kDefaultCalibration = 6;  ///< a component kind that no image may carry
constexpr std::string_view kDfuSePrefix = "DfuSe";

template <std::size_t N>
std::array<std::uint8_t, N> copy_array(std::span<const std::byte> from) noexcept {
  std::array<std::uint8_t, N> out{};
  if (from.size() == N) std::memcpy(out.data(), from.data(), N);
  return out;
}

bool starts_with(std::span<const std::byte> bytes, std::span<const std::uint8_t> prefix) noexcept {
  return bytes.size() >= prefix.size() && std::memcmp(bytes.data(), prefix.data(), prefix.size()) == 0;
}

bool is_dfuse(std::span<const std::byte> bytes) noexcept {
  return bytes.size() >= kDfuSePrefix.size() &&
         std::memcmp(bytes.data(), kDfuSePrefix.data(), kDfuSePrefix.size()) == 0;
}

/// Lengths and places that the header states, which must leave no room for bytes that nothing accounts for.
struct Places {
  std::uint32_t tlv_len = 0;
  std::uint32_t table_off = 0;
  std::uint32_t sig_off = 0;
};

bool consistent(const Manifest& m, const Places& p, std::uint32_t chunk_size) noexcept {
  if (chunk_size != kChunkSize || m.payload_len == 0 || m.payload_len > kMaxPayload) return false;
  if (m.chunk_count != (m.payload_len + kChunkSize - 1) / kChunkSize) return false;
  if (m.hw_rev_min > m.hw_rev_max || (m.flags & ~image_flags::kUsable) != 0) return false;
  const std::uint64_t table_off = std::uint64_t{kHeaderSize} + p.tlv_len;
  const std::uint64_t sig_off = table_off + 32ULL * m.chunk_count;
  return p.table_off == table_off && p.sig_off == sig_off && sig_off <= m.manifest_len;
}

bool read_header(std::span<const std::byte> header, Manifest& m, Places& p, Sha256Digest& table_sha) noexcept {
  ByteReader in(header);
  in.skip(kImageMagic.size() + 4);
  m.manifest_len = in.get<std::uint32_t>();
  m.payload_len = in.get<std::uint64_t>();
  const auto chunk_size = in.get<std::uint32_t>();
  m.chunk_count = in.get<std::uint32_t>();
  m.product_id = in.get<std::uint32_t>();
  m.hw_rev_min = in.get<std::uint16_t>();
  m.hw_rev_max = in.get<std::uint16_t>();
  m.version = read_version(in);
  m.security_counter = in.get<std::uint32_t>();
  m.flags = in.get<std::uint32_t>();
  m.build_time_unix_s = in.get<std::uint64_t>();
  table_sha = copy_array<32>(in.take(32));
  m.key_id = copy_array<16>(in.take(16));
  p.tlv_len = in.get<std::uint32_t>();
  p.table_off = in.get<std::uint32_t>();
  p.sig_off = in.get<std::uint32_t>();
  const std::size_t covered = in.position();
  return in.get<std::uint32_t>() == crc32(header.first(covered)) && in.ok() && consistent(m, p, chunk_size);
}

bool component_fits(std::span<const std::byte> value, std::uint64_t payload_len) noexcept {
  const std::optional<Component> c = parse_component(value);
  return c && c->kind >= 1 && c->kind < kDefaultCalibration && c->offset <= payload_len &&
         c->length <= payload_len - c->offset;
}

bool read_tlv(std::uint16_t type, std::span<const std::byte> value, Manifest& m) noexcept {
  ByteReader in(value);
  switch (type) {
    case tlv::kSecurityCounter:
      return value.size() == 4 && in.get<std::uint32_t>() == m.security_counter;
    case tlv::kComponent:
      return component_fits(value, m.payload_len);
    case tlv::kMinBootloader:
      m.min_bootloader = read_version(in);
      return value.size() == 8;
    case tlv::kProtocolRange:
      m.protocol = ProtocolRange{in.get<std::uint16_t>(), in.get<std::uint16_t>()};
      return value.size() == 4 && m.protocol->lowest <= m.protocol->highest;
    default:
      return true;
  }
}

bool read_tlvs(Manifest& m) noexcept {
  std::size_t read = 0;
  bool good = true;
  for_each_tlv(m, [&](std::uint16_t type, std::span<const std::byte> value) {
    read += 4 + value.size();
    good = good && read_tlv(type, value, m);
  });
  return good && read == m.tlvs.size();
}

/// Signature block and pad: exactly the stated number of entries, then nothing but 0xFF.
bool read_signatures(std::span<const std::byte> rest, Manifest& m) noexcept {
  ByteReader in(rest);
  const auto algorithm = in.get<std::uint16_t>();
  m.signature_count = in.get<std::uint16_t>();
  if (!in.ok() || algorithm != kAlgorithmEd25519 || m.signature_count > kMaxSignatures) return false;
  m.signatures = in.take(m.signature_count * kSignatureEntry);
  if (!in.ok() || (m.signature_count > 0 && m.signer(0) != m.key_id)) return false;
  const std::span<const std::byte> pad = in.take(in.remaining());
  return std::all_of(pad.begin(), pad.end(), [](std::byte b) { return b == std::byte{0xFF}; });
}

}  // namespace

std::size_t Manifest::chunk_length(std::uint32_t i) const noexcept {
  const std::uint64_t start = std::uint64_t{i} * kChunkSize;
  return start >= payload_len ? 0 : static_cast<std::size_t>(std::min<std::uint64_t>(kChunkSize, payload_len - start));
}

Sha256Digest Manifest::chunk_digest(std::uint32_t i) const noexcept {
  return copy_array<32>(chunk_table.subspan(std::size_t{i} * 32, 32));
}

KeyId Manifest::signer(std::size_t i) const noexcept {
  return copy_array<16>(signatures.subspan(i * kSignatureEntry, 16));
}

SignatureBytes Manifest::signature(std::size_t i) const noexcept {
  return copy_array<64>(signatures.subspan(i * kSignatureEntry + 16, 64));
}

Checked<std::uint32_t> manifest_length(std::span<const std::byte> header) noexcept {
  if (is_dfuse(header)) return refuse(Refusal::kDfuSe);
  if (!starts_with(header, kImageMagic) || header.size() < kHeaderSize) return refuse(Refusal::kMagic);
  ByteReader in(header);
  in.skip(kImageMagic.size());
  const auto version = in.get<std::uint16_t>();
  const auto length = in.get<std::uint16_t>();
  const auto manifest_len = in.get<std::uint32_t>();
  if (version != kHeaderVersion || length != kHeaderSize) return refuse(Refusal::kMagic);
  if (manifest_len == 0 || manifest_len % kManifestStep != 0 || manifest_len > kMaxManifest) {
    return refuse(Refusal::kMagic);
  }
  return manifest_len;
}

Checked<Manifest> parse_manifest(std::span<const std::byte> image) noexcept {
  if (image.size() < kHeaderSize && !is_dfuse(image)) return refuse(Refusal::kTruncated);
  const Checked<std::uint32_t> length = manifest_length(image);
  if (!length) return refuse(length.error());
  if (image.size() < *length) return refuse(Refusal::kTruncated);

  Manifest m;
  Places p;
  Sha256Digest table_sha{};
  m.bytes = image.first(*length);
  if (!read_header(m.bytes.first(kHeaderSize), m, p, table_sha)) return refuse(Refusal::kMagic);
  m.tlvs = m.bytes.subspan(kHeaderSize, p.tlv_len);
  m.chunk_table = m.bytes.subspan(p.table_off, p.sig_off - p.table_off);
  m.signed_part = m.bytes.first(p.sig_off);
  if (sha256(m.chunk_table) != table_sha || !read_tlvs(m)) return refuse(Refusal::kMagic);
  if (!read_signatures(m.bytes.subspan(p.sig_off), m)) return refuse(Refusal::kMagic);
  return m;
}

std::optional<Component> parse_component(std::span<const std::byte> value) noexcept {
  ByteReader in(value);
  Component c;
  c.kind = in.get<std::uint8_t>();
  c.slot = in.get<std::uint8_t>();
  const auto reserved = in.get<std::uint16_t>();
  c.offset = in.get<std::uint64_t>();
  c.length = in.get<std::uint64_t>();
  c.sha256 = copy_array<32>(in.take(32));
  if (!in.ok() || in.remaining() != 0 || reserved != 0) return std::nullopt;
  return c;
}

}  // namespace enamel::image
