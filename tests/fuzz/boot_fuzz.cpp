// Any two copies of the boot control block and any content of the slots, with power cuts while the bootloader writes:
// it boots what verifies, for as often as it is asked, and goes to recovery only when nothing can boot.
#include <algorithm>
#include <array>
#include <cstdint>

#include "firmware/boot/policy.hpp"
#include "firmware/device/sim/flash_model.hpp"
#include "tests/fuzz/byte_source.hpp"
#include "tests/fuzz/demand.hpp"

namespace {

using namespace enamel;
using namespace enamel::fw;
using test::demand;

class GivenContent final : public SlotJudge {
 public:
  explicit GivenContent(const std::array<bool, kSlots>& good) : good_(good) {}
  bool verifies(std::size_t slot) noexcept override {
    demand(++asked_[slot] <= 2, "a slot is hashed at most once a decision");  // a failed store decides again
    return good_[slot];
  }

 private:
  std::array<bool, kSlots> good_;
  std::array<int, kSlots> asked_{};
};

ControlBlock block_of(test::ByteSource& in) {
  ControlBlock block;
  block.seq = in.one_in(4) ? 0xFFFFFFFF : in.byte();
  block.active = in.byte() & 1U;
  block.min_security_counter = in.number<std::uint32_t>();
  for (SlotRecord& slot : block.slot) {
    slot.state = static_cast<SlotState>(in.byte() % 7);
    slot.tries = in.byte() % 5;
    slot.reason = in.byte();
    slot.security_counter = in.byte();
  }
  block.boot_count = in.byte();
  block.revoked = in.byte();
  return block;
}

/// One copy: as bytes come, or a block that a probe could have written, sometimes with a byte wrong.
ControlBytes copy_of(test::ByteSource& in) {
  const std::uint8_t kind = in.byte() % 8;
  if (kind > 1) {
    ControlBytes bytes = encode(block_of(in));
    if (kind == 2) bytes[in.below(bytes.size())] ^= static_cast<std::byte>(in.byte());
    return bytes;
  }
  ControlBytes bytes{};
  if (kind == 0) return bytes;
  for (std::byte& b : bytes) b = static_cast<std::byte>(in.byte());
  return bytes;
}

bool on_trial(const SlotRecord& slot) { return slot.state == SlotState::kPending || slot.state == SlotState::kTrial; }

bool lasts(const SlotRecord& slot) {
  return slot.state == SlotState::kConfirmed || slot.state == SlotState::kVerified || slot.state == SlotState::kEmpty;
}

std::optional<std::size_t> boot(ControlStore& store, SlotJudge& judge) {
  const std::optional<std::size_t> slot = choose_slot(store, judge);
#ifdef ENAMEL_FUZZ_CONTROL
  // Negative control: a bootloader that charges confirmed slots too.
  std::optional<ControlBlock> block = store.load();
  if (slot && block && block->slot[*slot].state == SlotState::kConfirmed) {
    --block->slot[*slot].tries;
    static_cast<void>(store.store(*block));
  }
#endif
  return slot;
}

/// What the stored block promises: something boots now; something boots for ever.
struct Promise {
  bool now = false, always = false;
};

Promise promise(const ControlBlock& block, const std::array<bool, kSlots>& good) {
  Promise p;
  for (std::size_t i = 0; i < kSlots; ++i) {
    p.always = p.always || (good[i] && lasts(block.slot[i]));
    p.now = p.now || (good[i] && on_trial(block.slot[i]) && block.slot[i].tries > 0);
  }
  p.now = p.now || p.always;
  return p;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  test::ByteSource in(data, size);
  static const FlashModel kErased(flash_map::kSlot);
  FlashModel flash = kErased;
  const std::array<bool, kSlots> good = {in.one_in(2), in.one_in(2)};
  const std::array<FlashRegion, 2> copies = {FlashRegion(flash, 0, kEraseBlock),
                                             FlashRegion(flash, kEraseBlock, kEraseBlock)};
  for (FlashRegion copy : copies) {
    const ControlBytes bytes = copy_of(in);
    const auto decoded = decode(bytes);
    demand(!decoded || encode(*decoded) == bytes, "decoding loses nothing");
    demand(copy.program(0, bytes) == FlashStatus::kOk, "the flash takes a copy");
  }
  ControlStore store(copies);
  const ControlBlock first = store.load().value_or(ControlBlock{});
  const bool forever = promise(first, good).always;
  GivenContent kept(good);
  demand(!forever || good[slot_to_keep(store, kept)], "recovery keeps what boots");
  for (int cycle = 0; cycle < 8; ++cycle) {
    const ControlBlock before = store.load().value_or(ControlBlock{});
    const bool cut = in.one_in(3);
    if (cut) flash.cut_at(flash.operations() + in.below(2), in.below(kControlSize + 1), in.byte());
    const std::uint64_t writes = flash.operations();
    GivenContent judge(good);
    const std::optional<std::size_t> slot = boot(store, judge);
    demand(!slot || good[*slot], "what boots verifies");
    const bool written = flash.operations() > writes;
    flash.restore_power();
    const ControlBlock after = store.load().value_or(ControlBlock{});
    if (!cut || !written) demand(slot.has_value() == promise(before, good).now, "recovery is the last choice");
    demand(!forever || promise(after, good).always, "a boot takes away nothing that would boot");
    for (std::size_t i = 0; i < kSlots; ++i) {
      demand(first.slot[i].state != SlotState::kConfirmed || after.slot[i] == first.slot[i],
             "a confirmed slot is not charged");
      demand(!(slot == i && on_trial(before.slot[i]) && !cut) || after.slot[i].tries + 1 == before.slot[i].tries,
             "a trial is paid for before the jump");
    }
    demand(after.min_security_counter == before.min_security_counter, "booting leaves the counter");
  }
  return 0;
}
