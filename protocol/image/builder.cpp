#include "protocol/image/builder.hpp"

#include <algorithm>
#include <utility>

#include "protocol/base/bytes.hpp"
#include "protocol/base/crc32.hpp"
#include "protocol/image/dfu_suffix.hpp"
#include "protocol/image/trust.hpp"

namespace enamel::image {
namespace {

template <std::size_t N>
void put_array(ByteWriter& out, const std::array<std::uint8_t, N>& bytes) {
  out.put_bytes(std::as_bytes(std::span(bytes)));
}

void put_tlv(ByteWriter& out, std::uint16_t type, std::span<const std::byte> value) {
  out.put(type);
  out.put(static_cast<std::uint16_t>(value.size()));
  out.put_bytes(value);
}

void put_component(ByteWriter& out, const Component& c, std::span<const std::byte> payload) {
  ByteWriter value;
  value.put(c.kind);
  value.put(c.slot);
  value.put(std::uint16_t{0});
  value.put(c.offset);
  value.put(c.length);
  put_array(value, sha256(payload.subspan(c.offset, c.length)));
  put_tlv(out, tlv::kComponent, value.bytes());
}

ByteWriter make_tlvs(const ImageDescription& d, std::span<const std::byte> payload) {
  ByteWriter out;
  ByteWriter counter;
  counter.put(d.security_counter);
  put_tlv(out, tlv::kSecurityCounter, counter.bytes());
  for (const Component& c : d.components) put_component(out, c, payload);
  if (!d.git_commit.empty()) put_tlv(out, tlv::kGitCommit, d.git_commit);
  if (d.min_bootloader) {
    ByteWriter value;
    put_version(value, *d.min_bootloader);
    put_tlv(out, tlv::kMinBootloader, value.bytes());
  }
  if (d.protocol) {
    ByteWriter value;
    value.put(d.protocol->lowest);
    value.put(d.protocol->highest);
    put_tlv(out, tlv::kProtocolRange, value.bytes());
  }
  if (!d.notes.empty()) put_tlv(out, tlv::kNotes, std::as_bytes(std::span(d.notes)));
  return out;
}

ByteWriter make_table(std::span<const std::byte> payload) {
  ByteWriter out;
  for (std::size_t at = 0; at < payload.size(); at += kChunkSize) {
    put_array(out, sha256(payload.subspan(at, std::min(kChunkSize, payload.size() - at))));
  }
  return out;
}

struct Sizes {
  std::uint64_t payload_len = 0;
  std::uint32_t tlv_len = 0;
  std::uint32_t manifest_len = 0;
  std::uint32_t sig_off = 0;
};

Sizes sizes_of(std::size_t payload_len, std::size_t tlv_len, std::size_t table_len, std::size_t signers) {
  const std::size_t sig_off = kHeaderSize + tlv_len + table_len;
  const std::size_t end = sig_off + 4 + signers * kSignatureEntry;
  return {payload_len, static_cast<std::uint32_t>(tlv_len),
          static_cast<std::uint32_t>((end + kManifestStep - 1) / kManifestStep * kManifestStep),
          static_cast<std::uint32_t>(sig_off)};
}

void put_header(ByteWriter& out, const ImageDescription& d, const ByteWriter& table, const Sizes& sizes,
                const KeyId& first) {
  put_array(out, kImageMagic);
  out.put(std::uint16_t{1});
  out.put(static_cast<std::uint16_t>(kHeaderSize));
  out.put(sizes.manifest_len);
  out.put(sizes.payload_len);
  out.put(static_cast<std::uint32_t>(kChunkSize));
  out.put(static_cast<std::uint32_t>(table.size() / 32));
  out.put(d.product_id);
  out.put(d.hw_rev_min);
  out.put(d.hw_rev_max);
  put_version(out, d.version);
  out.put(d.security_counter);
  out.put(d.flags);
  out.put(d.build_time_unix_s);
  put_array(out, sha256(table.bytes()));
  put_array(out, first);
  out.put(sizes.tlv_len);
  out.put(static_cast<std::uint32_t>(kHeaderSize + sizes.tlv_len));
  out.put(sizes.sig_off);
  out.put(crc32(out.bytes()));
}

Result<void> check(const ImageDescription& d, std::span<const std::byte> payload, std::size_t signers) {
  if (payload.empty() || payload.size() > kMaxPayload) {
    return fail(ErrorCode::kUsage, "payload of " + std::to_string(payload.size()) + " bytes: 1 to " +
                                       std::to_string(kMaxPayload) + " are possible");
  }
  for (const Component& c : d.components) {
    if (c.offset > payload.size() || c.length > payload.size() - c.offset) {
      return fail(ErrorCode::kUsage, "component of kind " + std::to_string(c.kind) + " lies outside the payload");
    }
  }
  if (!d.git_commit.empty() && d.git_commit.size() != 20) return fail(ErrorCode::kUsage, "git commit: 20 bytes");
  if (d.notes.size() > 4096) return fail(ErrorCode::kUsage, "notes longer than 4096 bytes");
  if (d.hw_rev_min > d.hw_rev_max) return fail(ErrorCode::kUsage, "hardware range: lowest revision above the highest");
  if (signers > kMaxSignatures) return fail(ErrorCode::kUsage, "more than two signatures");
  return {};
}

}  // namespace

Result<std::vector<std::byte>> build_image(const ImageDescription& description, std::span<const std::byte> payload,
                                           std::span<const Signer> signers) {
  ENAMEL_TRY(check(description, payload, signers.size()));
  const ByteWriter tlvs = make_tlvs(description, payload);
  const ByteWriter table = make_table(payload);
  const Sizes sizes = sizes_of(payload.size(), tlvs.size(), table.size(), signers.size());
  if (sizes.manifest_len > kMaxManifest) return fail(ErrorCode::kUsage, "manifest longer than 65536 bytes");

  ByteWriter out;
  const KeyId first = signers.empty() ? KeyId{} : key_id(signers.front().key);
  put_header(out, description, table, sizes, first);
  out.put_bytes(tlvs.bytes());
  out.put_bytes(table.bytes());

  const std::vector<std::byte> message(out.bytes().begin(), out.bytes().end());
  out.put(std::uint16_t{1});
  out.put(static_cast<std::uint16_t>(signers.size()));
  for (const Signer& s : signers) {
    put_array(out, key_id(s.key));
    put_array(out, s.sign(message));
  }
  while (out.size() < sizes.manifest_len) out.put(std::uint8_t{0xFF});
  out.put_bytes(payload);
  const auto device = static_cast<std::uint16_t>(description.version.major << 8U | description.version.minor);
  out.put_bytes(make_suffix(out.bytes(), DfuSuffix{.device = device}));
  return out.release();
}

}  // namespace enamel::image
