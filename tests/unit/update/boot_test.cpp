// Boot control block and boot decision, row by row.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "firmware/boot/policy.hpp"
#include "firmware/boot/transitions.hpp"
#include "firmware/device/sim/flash_model.hpp"
#include "protocol/base/rng.hpp"

namespace enamel::fw {
namespace {

using enum SlotState;

class FixedJudge final : public SlotJudge {
 public:
  FixedJudge(bool a, bool b) : good_{a, b} {}
  bool verifies(std::size_t slot) noexcept override {
    ++asked[slot];
    return good_[slot];
  }
  std::array<int, kSlots> asked{};

 private:
  std::array<bool, kSlots> good_;
};

ControlBlock block_of(SlotState a, SlotState b, std::uint8_t active = 0, std::uint8_t tries = kTrialBoots) {
  ControlBlock block;
  block.active = active;
  block.slot[0].state = a;
  block.slot[1].state = b;
  for (SlotRecord& slot : block.slot) slot.tries = tries;
  return block;
}

std::optional<std::size_t> boots(const ControlBlock& block, bool a_good = true, bool b_good = true) {
  FixedJudge judge(a_good, b_good);
  return decide(block, judge).slot;
}

constexpr std::optional<std::size_t> kA = 0, kB = 1, kRecovery = std::nullopt;

TEST(BootDecision, in_the_order_of_the_specification) {
  EXPECT_EQ(boots(block_of(kConfirmed, kPending)), kB);
  EXPECT_EQ(boots(block_of(kConfirmed, kTrial)), kB);
  EXPECT_EQ(boots(block_of(kConfirmed, kConfirmed, 1)), kB);
  EXPECT_EQ(boots(block_of(kConfirmed, kEmpty, 1)), kA);
  EXPECT_EQ(boots(block_of(kConfirmed, kVerified, 1)), kA);
  EXPECT_EQ(boots(block_of(kBad, kVerified)), kB);
  EXPECT_EQ(boots(block_of(kConfirmed, kWriting, 1)), kA);
  EXPECT_EQ(boots(block_of(kWriting, kBad)), kRecovery);
}

TEST(BootDecision, nothing_boots_that_does_not_verify) {
  EXPECT_EQ(boots(block_of(kConfirmed, kPending), true, false), kA);
  EXPECT_EQ(boots(block_of(kConfirmed, kConfirmed), false, true), kB);
  EXPECT_EQ(boots(block_of(kConfirmed, kConfirmed), false, false), kRecovery);
}

TEST(BootDecision, zero_tries_lead_to_the_other_slot_whatever_the_states) {
  for (const SlotState a : {kVerified, kConfirmed}) {
    for (const SlotState b : {kEmpty, kWriting, kVerified, kPending, kTrial, kConfirmed, kBad}) {
      for (const std::uint8_t active : {std::uint8_t{0}, std::uint8_t{1}}) {
        EXPECT_NE(boots(block_of(a, b, active, 0), true, false), kRecovery);
      }
    }
  }
}

TEST(BootDecision, trials_are_paid_for_confirmed_slots_never) {
  FixedJudge judge(true, true);
  const BootDecision trial = decide(block_of(kConfirmed, kPending), judge);
  EXPECT_EQ(trial.block.slot[1].tries, kTrialBoots - 1);
  EXPECT_EQ(trial.block.slot[1].state, kTrial);
  const ControlBlock confirmed = block_of(kConfirmed, kConfirmed);
  EXPECT_EQ(decide(confirmed, judge).block, confirmed);
}

TEST(BootDecision, three_power_cycles_during_a_trial_end_in_the_old_firmware) {
  FlashModel flash(flash_map::kSize);
  ControlStore store(boot_regions(flash).control);
  ASSERT_TRUE(store.store(block_of(kConfirmed, kPending)));
  FixedJudge judge(true, true);
  for (int cycle = 0; cycle < kTrialBoots; ++cycle) EXPECT_EQ(choose_slot(store, judge), kB);
  for (int cycle = 0; cycle < 10; ++cycle) EXPECT_EQ(choose_slot(store, judge), kA);
  EXPECT_EQ(store.load()->slot[1].state, kBad);
  EXPECT_EQ(store.load()->slot[1].reason, bad_reason::kNoTriesLeft);
}

TEST(BootDecision, a_healthy_trial_survives_power_cycles_up_to_its_last_try) {
  FlashModel flash(flash_map::kSize);
  ControlStore store(boot_regions(flash).control);
  ASSERT_TRUE(store.store(block_of(kConfirmed, kPending)));
  FixedJudge judge(true, true);
  for (int cycle = 0; cycle < kTrialBoots; ++cycle) EXPECT_EQ(choose_slot(store, judge), kB);
  EXPECT_EQ(store.load()->slot[1].tries, 0);
  ASSERT_TRUE(store.store(confirm(*store.load(), 1)));
  for (int cycle = 0; cycle < 10; ++cycle) EXPECT_EQ(choose_slot(store, judge), kB);
}

/// Every state, number of tries, active slot and content: calls check(block, what verifies).
template <class Check>
void for_every_block(Check check) {
  const std::array<SlotState, 7> states = {kEmpty, kWriting, kVerified, kPending, kTrial, kConfirmed, kBad};
  for (unsigned n = 0; n < 7 * 7 * 2 * 4 * 4 * 4; ++n) {
    unsigned rest = n;
    const auto draw = [&](unsigned choices) { return std::exchange(rest, rest / choices) % choices; };
    ControlBlock block = block_of(states[draw(7)], states[draw(7)], static_cast<std::uint8_t>(draw(2)));
    for (SlotRecord& slot : block.slot) slot.tries = static_cast<std::uint8_t>(draw(4));
    check(block, std::array<bool, kSlots>{draw(2) == 1, draw(2) == 1});
  }
}

bool may_boot(const SlotRecord& slot) {
  if (slot.state == kPending || slot.state == kTrial) return slot.tries > 0;
  return slot.state == kConfirmed || slot.state == kVerified || slot.state == kEmpty;
}

TEST(BootDecision, every_block_boots_what_verifies_and_loses_nothing_over_power_cycles) {
  for_every_block([](const ControlBlock& first, const std::array<bool, kSlots>& good) {
    ControlBlock block = first;
    for (int cycle = 0; cycle < 10; ++cycle) {
      bool bootable = false, lasting = false;
      for (std::size_t i = 0; i < kSlots; ++i) {
        const bool trial = block.slot[i].state == kPending || block.slot[i].state == kTrial;
        bootable = bootable || (good[i] && may_boot(block.slot[i]));
        lasting = lasting || (good[i] && may_boot(block.slot[i]) && !trial);
      }
      FixedJudge judge(good[0], good[1]);
      const BootDecision d = decide(block, judge);
      ASSERT_EQ(d.slot.has_value(), bootable);
      ASSERT_TRUE(!d.slot || good[*d.slot]);
      ASSERT_LE(*std::max_element(judge.asked.begin(), judge.asked.end()), 1);
      for (std::size_t i = 0; i < kSlots; ++i) {
        ASSERT_TRUE(first.slot[i].state != kConfirmed || d.block.slot[i] == first.slot[i]);
      }
      ASSERT_TRUE(!lasting || decide(d.block, judge).slot) << "a boot took away what would boot";
      block = d.block;
    }
  });
}

TEST(BootDecision, recovery_keeps_the_slot_that_is_likelier_to_boot) {
  FlashModel flash(flash_map::kSize);
  ControlStore store(boot_regions(flash).control);
  FixedJudge both(true, true), only_b(false, true), none(false, false);
  EXPECT_EQ(slot_to_keep(store, only_b), 1U) << "no block at all";
  ASSERT_TRUE(store.store(block_of(kConfirmed, kTrial)));
  EXPECT_EQ(slot_to_keep(store, both), 0U) << "a trial may fail";
  EXPECT_EQ(slot_to_keep(store, only_b), 1U);
  ASSERT_TRUE(store.store(block_of(kConfirmed, kConfirmed, 1)));
  EXPECT_EQ(slot_to_keep(store, both), 1U);
  EXPECT_EQ(slot_to_keep(store, none), 1U);
}

TEST(BootDecision, counter_and_revocation_do_not_stop_a_boot) {
  for_every_block([](const ControlBlock& block, const std::array<bool, kSlots>& good) {
    ControlBlock strict = block;
    strict.min_security_counter = 0xFFFFFFFF;
    strict.revoked = 0xFFFFFFFF;
    ASSERT_EQ(boots(strict, good[0], good[1]), boots(block, good[0], good[1]));
  });
}

TEST(BootDecision, a_trial_that_cannot_be_written_down_does_not_boot) {
  FlashModel flash(flash_map::kSize);
  ControlStore store(boot_regions(flash).control);
  ASSERT_TRUE(store.store(block_of(kConfirmed, kPending)));
  // Reads work, writes do not: a worn part.
  flash.cut_at(flash.operations(), 0, 1);
  FixedJudge judge(true, true);
  const std::optional<ControlBlock> loaded = store.load();
  ASSERT_TRUE(loaded.has_value());
  EXPECT_FALSE(store.store(decide(*loaded, judge).block));
  EXPECT_EQ(decide(*loaded, judge, false).slot, kA);
}

TEST(BootDecision, without_a_block_what_verifies_boots) {
  FlashModel flash(flash_map::kSize);
  ControlStore store(boot_regions(flash).control);
  FixedJudge only_b(false, true), none(false, false);
  EXPECT_EQ(choose_slot(store, only_b), kB);
  EXPECT_EQ(choose_slot(store, none), kRecovery);
}

TEST(ControlBlockFormat, any_flipped_bit_is_seen) {
  ControlBlock block = block_of(kConfirmed, kTrial, 1);
  block.seq = 77;
  block.revoked = 2;
  ControlBytes bytes = encode(block);
  EXPECT_EQ(decode(bytes), block);
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
    EXPECT_FALSE(decode(bytes).has_value()) << bit;
    bytes[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
  }
}

TEST(ControlBlockFormat, the_newer_copy_counts_across_the_wrap_of_the_sequence) {
  FlashModel flash(flash_map::kSize);
  const BootRegions regions = boot_regions(flash);
  ControlBlock block = block_of(kConfirmed, kEmpty);
  block.seq = 0xFFFFFFFF;
  ASSERT_EQ(flash.program(flash_map::kControl, encode(block)), FlashStatus::kOk);
  ControlStore store(regions.control);
  block.active = 1;
  ASSERT_TRUE(store.store(block));
  EXPECT_EQ(store.load()->seq, 0U);
  EXPECT_EQ(store.load()->active, 1);
}

}  // namespace
}  // namespace enamel::fw
