#include "protocol/image/status_block.hpp"

#include <cstring>

#include "protocol/image/fixed_writer.hpp"

namespace enamel::image {
namespace {

constexpr std::uint32_t kMagic = 0x41545345;  // "ESTA"
constexpr std::uint16_t kVersion = 1;

template <std::size_t N>
void get_array(ByteReader& in, std::array<std::uint8_t, N>& out) noexcept {
  const std::span<const std::byte> bytes = in.take(N);
  if (bytes.size() == N) std::memcpy(out.data(), bytes.data(), N);
}

}  // namespace

StatusBytes encode(const StatusBlock& s) noexcept {
  StatusBytes bytes{};
  FixedWriter out(bytes);
  out.put(kMagic);
  out.put(kVersion);
  out.put(s.active);
  out.put_array(s.slot_state);
  out.put_array(s.tries);
  for (const ImageVersion& v : s.version) put_version(out, v);
  out.put(s.min_security_counter);
  out.put(s.chunks_done);
  out.put(s.chunks_total);
  out.put_array(s.manifest_sha);
  out.put_array(s.serial);
  out.put(s.hw_rev);
  out.put(s.battery_mv);
  out.put(s.last_error);
  return bytes;
}

std::optional<StatusBlock> decode_status(std::span<const std::byte> bytes) noexcept {
  ByteReader in(bytes);
  if (in.get<std::uint32_t>() != kMagic || in.get<std::uint16_t>() != kVersion) return std::nullopt;
  StatusBlock s;
  s.active = in.get<std::uint8_t>();
  get_array(in, s.slot_state);
  get_array(in, s.tries);
  for (ImageVersion& v : s.version) v = read_version(in);
  s.min_security_counter = in.get<std::uint32_t>();
  s.chunks_done = in.get<std::uint32_t>();
  s.chunks_total = in.get<std::uint32_t>();
  get_array(in, s.manifest_sha);
  get_array(in, s.serial);
  s.hw_rev = in.get<std::uint16_t>();
  s.battery_mv = in.get<std::uint16_t>();
  s.last_error = in.get<std::uint32_t>();
  if (!in.ok() || in.remaining() != 0 || s.active > 1) return std::nullopt;
  return s;
}

}  // namespace enamel::image
