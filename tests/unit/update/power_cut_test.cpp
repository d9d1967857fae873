// The supply fails at every write of an update: the old firmware or the whole new one boots each time.
#include <gtest/gtest.h>

#include "firmware/boot/transitions.hpp"
#include "protocol/base/rng.hpp"
#include "tests/support/full_form.hpp"
#include "tests/unit/update/cut_bench.hpp"

namespace enamel::fw {
namespace {

using test::BootFunction;
using test::CutBench;

constexpr std::size_t kOldPayload = 300'000;
constexpr std::size_t kNewPayload = 16U << 20U;
constexpr int kPowerCycles = 5;  ///< more than a trial has

std::optional<std::size_t> ours(ControlStore& store, SlotJudge& judge) { return choose_slot(store, judge); }

/// Boots again and again: something that verifies, each time.
::testing::AssertionResult keeps_booting(CutBench& bench, FlashModel flash, const BootFunction& boot) {
  for (int cycle = 0; cycle < kPowerCycles; ++cycle) {
    const std::optional<std::size_t> slot = bench.boot(flash, boot);
    if (!slot) return ::testing::AssertionFailure() << "brick at power cycle " << cycle;
    if (!bench.judge().verifies(*slot)) return ::testing::AssertionFailure() << "boots a slot that does not verify";
  }
  return ::testing::AssertionSuccess();
}

/// The whole flow of an update with a look at the memory before every operation.
class Flow {
 public:
  Flow(CutBench& bench, BootFunction boot) : bench_(&bench), boot_(std::move(boot)) {}

  /// Runs the flow on a copy; at every operation calls visit(memory, operation).
  template <class Visit>
  void run(Visit visit) {
    FlashModel flash = bench_->flash();
    flash.watch([&](const FlashModel::Operation& op) { visit(flash, op); });
    ASSERT_FALSE(bench_->download(flash, 0).has_value());
    ASSERT_EQ(bench_->boot_and_confirm(flash, boot_), std::size_t{1});
    flash.watch({});
    ASSERT_EQ(ControlStore(boot_regions(flash).control).load()->slot[1].state, SlotState::kConfirmed);
  }

 private:
  CutBench* bench_;
  BootFunction boot_;
};

bool in_control(const FlashModel::Operation& op) { return op.offset < flash_map::kSlot; }

TEST(PowerCut, no_position_bricks) {
  CutBench bench(kOldPayload, kNewPayload);
  std::uint64_t positions = 0, scratch = 0;
  Flow(bench, ours).run([&](const FlashModel& memory, const FlashModel::Operation& op) {
    // Every byte of a boot-block write; a sector of the payload is torn as a whole.
    const std::size_t steps = in_control(op) && !op.erase() ? op.length + 1 : 1;
    for (std::size_t whole = 0; whole < steps; ++whole) {
      FlashModel cut = memory;
      cut.watch({});
      cut.tear(op, whole, positions);
      ++positions;
      ASSERT_TRUE(keeps_booting(bench, cut, ours)) << "cut in operation " << op.index << " after byte " << whole;
      if (positions % 180 == 0) {
        bench.judge().look_at(cut);
        for (std::size_t slot = 0; slot < kSlots; ++slot) {
          ASSERT_EQ(bench.judge().verifies(slot), bench.judge().verifies_from_scratch(slot));
        }
        ++scratch;
      }
    }
  });
  EXPECT_GE(positions, 35'000U);
  EXPECT_GE(scratch, 200U);
  RecordProperty("positions", static_cast<int>(positions));
  RecordProperty("from_scratch", static_cast<int>(scratch));
}

/// Charges confirmed slots for a boot like those on trial, and stops when no tries are left.
std::optional<std::size_t> charges_everybody(ControlStore& store, SlotJudge& judge) {
  const std::optional<ControlBlock> loaded = store.load();
  if (!loaded) return std::nullopt;
  ControlBlock block = *loaded;
  for (const std::size_t i : {std::size_t{block.active}, std::size_t{1} - block.active}) {
    SlotRecord& slot = block.slot[i];
    if (slot.state == SlotState::kEmpty) continue;
    if (slot.tries == 0 || !judge.verifies(i)) continue;
    --slot.tries;
    if (!store.store(block)) return std::nullopt;
    return i;
  }
  return std::nullopt;
}

TEST(PowerCut, control_a_policy_that_charges_confirmed_slots_is_caught) {
  CutBench bench(kOldPayload, 100'000);
  ControlStore store(boot_regions(bench.flash()).control);
  ControlBlock block = *store.load();
  block.slot[0].tries = kTrialBoots;
  ASSERT_TRUE(store.store(block));
  EXPECT_FALSE(keeps_booting(bench, bench.flash(), charges_everybody));
  EXPECT_TRUE(keeps_booting(bench, bench.flash(), ours));
}

/// Jumps to what the block says without looking at the slot.
std::optional<std::size_t> believes(ControlStore& store, SlotJudge&) {
  const std::optional<ControlBlock> block = store.load();
  return block ? std::optional<std::size_t>(block->slot[1].state == SlotState::kEmpty ? 0 : 1) : std::nullopt;
}

TEST(PowerCut, control_a_policy_that_does_not_verify_is_caught) {
  CutBench bench(kOldPayload, 100'000);
  int caught = 0;
  Flow(bench, ours).run([&](const FlashModel& memory, const FlashModel::Operation& op) {
    FlashModel cut = memory;
    cut.watch({});
    cut.tear(op, 0, 1);
    caught += keeps_booting(bench, cut, believes) ? 0 : 1;
  });
  EXPECT_GT(caught, 100);
}

/// `wanted` of all that is offered, each equally likely (reservoir sampling).
class Sample {
 public:
  Sample(std::size_t wanted, Rng& rng) : wanted_(wanted), rng_(&rng) {}
  /// The supply fails in `op`, after a random part of it.
  void offer(const FlashModel& memory, const FlashModel::Operation& op) {
    const std::size_t place = seen_ < wanted_ ? seen_ : rng_->below(static_cast<std::uint32_t>(seen_ + 1));
    ++seen_;
    if (place >= wanted_) return;
    if (place == kept_.size()) kept_.push_back(memory);
    FlashModel& cut = kept_[place] = memory;
    cut.watch({});
    cut.tear(op, rng_->below(static_cast<std::uint32_t>(op.length) + 1), rng_->next_u32());
  }
  [[nodiscard]] std::vector<FlashModel>& kept() { return kept_; }

 private:
  std::size_t wanted_, seen_ = 0;
  Rng* rng_;
  std::vector<FlashModel> kept_;
};

TEST(PowerCut, two_cuts_in_a_row_do_not_brick_and_the_update_still_succeeds) {
  constexpr std::size_t kFirstCuts = 110, kSecondCuts = 10;
  const bool full = enamel::test::is_full_form();
  CutBench bench(kOldPayload, full ? kNewPayload : 1U << 20U);
  Rng rng(4, 0, 0);
  Sample first(kFirstCuts, rng);
  Flow(bench, ours).run([&](const FlashModel& memory, const FlashModel::Operation& op) { first.offer(memory, op); });
  int pairs = 0;
  for (FlashModel& flash : first.kept()) {
    const std::optional<std::size_t> running = bench.boot_and_confirm(flash, ours);
    ASSERT_TRUE(running.has_value());
    if (*running == 1) continue;  // the cut came after the update was whole
    Sample second(kSecondCuts, rng);
    flash.watch([&](const FlashModel::Operation& op) { second.offer(flash, op); });
    ASSERT_FALSE(bench.download(flash, 0).has_value());
    ASSERT_EQ(bench.boot_and_confirm(flash, ours), std::size_t{1});
    flash.watch({});
    for (const FlashModel& cut : second.kept()) {
      ASSERT_TRUE(keeps_booting(bench, cut, ours));
      ++pairs;
    }
    // A third download is not disturbed: it ends with the new firmware.
    FlashModel& last = second.kept().back();
    const std::optional<std::size_t> again = bench.boot_and_confirm(last, ours);
    ASSERT_TRUE(again.has_value());
    if (*again == 1) continue;
    ASSERT_FALSE(bench.download(last, 0).has_value());
    ASSERT_EQ(bench.boot_and_confirm(last, ours), std::size_t{1});
  }
  EXPECT_GE(pairs, 1000);
  RecordProperty("pairs", pairs);
}

TEST(PowerCut, resume_writes_only_what_is_missing) {
  CutBench bench(kOldPayload, 1U << 20U);
  FlashModel flash = bench.flash();
  // Manifest, boot block, half of the payload.
  flash.cut_at(flash.operations() + 1100, 0, 1);
  EXPECT_EQ(bench.download(flash, 0), image::Refusal::kFlashWrite);
  flash.restore_power();
  const std::uint64_t before = flash.operations();
  EXPECT_FALSE(bench.download(flash, 0).has_value());
  EXPECT_LT(flash.operations() - before, 1100U);
}

}  // namespace
}  // namespace enamel::fw
