#include "firmware/boot/control_block.hpp"

#include <algorithm>
#include <cstring>

#include "protocol/base/bytes.hpp"
#include "protocol/base/crc32.hpp"
#include "protocol/image/fixed_writer.hpp"

namespace enamel::fw {
namespace {

constexpr std::uint32_t kMagic = 0x42434245;  // "EBCB"
constexpr std::size_t kCrcAt = kControlSize - 4;

void put_slot(image::FixedWriter& out, const SlotRecord& slot) noexcept {
  out.put(static_cast<std::uint8_t>(slot.state));
  out.put(slot.tries);
  out.put(slot.reason);
  out.put(std::uint8_t{0});
  image::put_version(out, slot.version);
  out.put(slot.security_counter);
  out.put_array(slot.manifest_sha);
}

bool get_slot(ByteReader& in, SlotRecord& slot) noexcept {
  const auto state = in.get<std::uint8_t>();
  slot.state = static_cast<SlotState>(state);
  slot.tries = in.get<std::uint8_t>();
  slot.reason = in.get<std::uint8_t>();
  const auto reserved = in.get<std::uint8_t>();
  slot.version = image::read_version(in);
  slot.security_counter = in.get<std::uint32_t>();
  const std::span<const std::byte> sha = in.take(slot.manifest_sha.size());
  if (!in.ok() || reserved != 0 || state > static_cast<std::uint8_t>(SlotState::kBad)) return false;
  std::memcpy(slot.manifest_sha.data(), sha.data(), sha.size());
  return true;
}

bool newer(std::uint32_t a, std::uint32_t b) noexcept { return static_cast<std::int32_t>(a - b) > 0; }

}  // namespace

ControlBytes encode(const ControlBlock& block) noexcept {
  ControlBytes bytes{};
  image::FixedWriter out(bytes);
  out.put(kMagic);
  out.put(block.seq);
  out.put(block.active);
  out.put(std::uint8_t{0});
  out.put(std::uint16_t{0});
  out.put(block.min_security_counter);
  for (const SlotRecord& slot : block.slot) put_slot(out, slot);
  out.put(block.boot_count);
  out.put(block.revoked);
  const std::uint32_t crc = crc32(std::span(bytes).first(kCrcAt));
  std::memcpy(bytes.data() + kCrcAt, &crc, sizeof crc);
  return bytes;
}

std::optional<ControlBlock> decode(std::span<const std::byte> bytes) noexcept {
  if (bytes.size() != kControlSize) return std::nullopt;
  ByteReader crc(bytes.subspan(kCrcAt));
  if (crc.get<std::uint32_t>() != crc32(bytes.first(kCrcAt))) return std::nullopt;
  ByteReader in(bytes.first(kCrcAt));
  ControlBlock block;
  if (in.get<std::uint32_t>() != kMagic) return std::nullopt;
  block.seq = in.get<std::uint32_t>();
  block.active = in.get<std::uint8_t>();
  const auto flags = in.get<std::uint8_t>();
  const auto reserved = in.get<std::uint16_t>();
  block.min_security_counter = in.get<std::uint32_t>();
  if (block.active >= kSlots || flags != 0 || reserved != 0) return std::nullopt;
  for (SlotRecord& slot : block.slot) {
    if (!get_slot(in, slot)) return std::nullopt;
  }
  block.boot_count = in.get<std::uint32_t>();
  block.revoked = in.get<std::uint32_t>();
  const std::span<const std::byte> rest = in.take(in.remaining());
  if (std::any_of(rest.begin(), rest.end(), [](std::byte b) { return b != std::byte{0}; })) return std::nullopt;
  return block;
}

std::optional<ControlBlock> ControlStore::load(std::size_t copy) const noexcept {
  ControlBytes bytes{};
  if (copies_[copy].read(0, bytes) != FlashStatus::kOk) return std::nullopt;
  return decode(bytes);
}

std::optional<ControlBlock> ControlStore::load() const noexcept {
  const std::optional<ControlBlock> first = load(0), second = load(1);
  if (!first) return second;
  if (!second) return first;
  return newer(second->seq, first->seq) ? second : first;
}

bool ControlStore::store(ControlBlock block) noexcept {
  const std::optional<ControlBlock> first = load(0), second = load(1);
  const std::size_t older = !first || (second && newer(second->seq, first->seq)) ? 0 : 1;
  const std::optional<ControlBlock>& kept = older == 0 ? second : first;
  block.seq = kept ? kept->seq + 1 : 1;
  FlashRegion& copy = copies_[older];
  if (copy.erase(0) != FlashStatus::kOk || copy.program(0, encode(block)) != FlashStatus::kOk) return false;
  return load(older) == block;
}

bool ControlStore::store_twice(const ControlBlock& block) noexcept {
  if (!store(block)) return false;
  static_cast<void>(store(block));
  return true;
}

}  // namespace enamel::fw
