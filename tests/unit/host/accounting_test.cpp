#include "host/report/accounting.hpp"

#include <gtest/gtest.h>

#include "protocol/base/rng.hpp"

namespace enamel::host {
namespace {

LossLedger ledger_of_ten() {
  LossLedger ledger;
  for (std::uint64_t seq = 0; seq < 10; ++seq) {
    ledger.received(seq);
    ledger.accepted();
    ledger.fused();
  }
  ledger.probe_status({.begun = 10, .emitted = 10, .given_up = 0, .queue_full = 0});
  return ledger;
}

TEST(LossLedger, balances_when_every_burst_arrives) {
  const BurstCounts counts = ledger_of_ten().counts();
  EXPECT_EQ(counts.captured, 10U);
  EXPECT_EQ(counts.fused, 10U);
  EXPECT_TRUE(check(counts));
}

TEST(LossLedger, counts_loss_on_the_wire_including_the_tail) {
  LossLedger ledger = ledger_of_ten();
  ledger.probe_status({.begun = 12, .emitted = 12, .given_up = 0, .queue_full = 0});
  const BurstCounts counts = ledger.counts();
  EXPECT_EQ(counts.lost_on_wire, 2U);
  const auto verdict = check(counts);
  ASSERT_FALSE(verdict);
  EXPECT_EQ(verdict.error().code, ErrorCode::kDataLoss);
}

// Damaged places of a recording do not tell their numbers: before the first burst that does, among them, or behind.
TEST(LossLedger, damaged_bursts_are_counted_wherever_they_lie) {
  for (const std::uint64_t first : {std::uint64_t{0}, std::uint64_t{1}}) {
    LossLedger ledger;
    for (std::uint64_t seq = first; seq < first + 7; ++seq) {
      ledger.received(seq);
      ledger.accepted();
      ledger.fused();
    }
    ledger.received_unreadable();
    ledger.damaged();
    const BurstCounts counts = ledger.counts();
    EXPECT_EQ(counts.captured, 8U) << first;
    EXPECT_EQ(counts.incomplete, 1U) << first;
    EXPECT_EQ(counts.lost_on_wire, 0U) << first;
    EXPECT_EQ(check(counts).error().code, ErrorCode::kDataLoss) << first;
  }
}

TEST(LossLedger, shedding_alone_is_no_error) {
  LossLedger ledger = ledger_of_ten();
  ledger.received(10);
  ledger.shed();
  ledger.probe_status({.begun = 14, .emitted = 11, .given_up = 0, .queue_full = 3});
  EXPECT_EQ(ledger.counts().shed, 4U);
  EXPECT_TRUE(check(ledger.counts()));
}

TEST(LossLedger, reasons_of_rejection_add_up_to_accepted) {
  LossLedger ledger = ledger_of_ten();
  ledger.received(10);
  ledger.accepted();
  ledger.rejected("too_dark");
  ledger.probe_status({.begun = 11, .emitted = 11, .given_up = 0, .queue_full = 0});
  EXPECT_TRUE(check(ledger.counts()));
  EXPECT_EQ(ledger.counts().rejected.at("too_dark"), 1U);
}

// Negative controls: a burst that vanishes without a counter must be noticed on either side.
TEST(LossLedger, notices_a_stage_that_filters_silently) {
  LossLedger ledger = ledger_of_ten();
  ledger.received(10);
  ledger.accepted();  // neither fused nor rejected
  ledger.probe_status({.begun = 11, .emitted = 11, .given_up = 0, .queue_full = 0});
  const auto verdict = check(ledger.counts());
  ASSERT_FALSE(verdict);
  EXPECT_EQ(verdict.error().code, ErrorCode::kAccounting);
}

TEST(LossLedger, notices_a_burst_dropped_on_the_host_without_a_counter) {
  LossLedger ledger = ledger_of_ten();
  ledger.received(10);  // neither shed, damaged nor accepted
  ledger.probe_status({.begun = 11, .emitted = 11, .given_up = 0, .queue_full = 0});
  const auto verdict = check(ledger.counts());
  ASSERT_FALSE(verdict);
  EXPECT_EQ(verdict.error().code, ErrorCode::kAccounting);
}

TEST(LossLedger, keeps_the_counts_of_a_probe_that_died_and_came_back) {
  LossLedger ledger = ledger_of_ten();
  // Killed while it assembled burst 11: that one is incomplete, and one more arrived after its last status.
  ledger.probe_status({.begun = 11, .emitted = 10, .given_up = 0, .queue_full = 0});
  ledger.probe_restarted();
  for (std::uint64_t seq = 0; seq < 5; ++seq) {
    ledger.received(seq);
    ledger.accepted();
    ledger.fused();
  }
  const BurstCounts counts = ledger.counts();
  EXPECT_EQ(counts.captured, 16U);
  EXPECT_EQ(counts.incomplete, 1U);
  EXPECT_EQ(counts.accepted, 15U);
}

// A burst that the last status called begun, and that arrived since, is one burst.
TEST(LossLedger, never_counts_more_than_the_probe_began_whenever_it_died) {
  Rng rng(11, 0, 0);
  for (int life = 0; life < 500; ++life) {
    LossLedger ledger;
    ProbeCounts truth;
    std::uint64_t settled_since_status = 0;
    for (std::uint32_t n = 0, events = 1 + rng.below(60); n < events; ++n) {
      const bool under_way = truth.begun > truth.emitted + truth.given_up;
      if (!under_way) {
        ++truth.begun;
      } else if (rng.below(10) == 0) {
        ++truth.given_up;
        ++settled_since_status;
      } else {
        ledger.received(truth.emitted++);
        ledger.accepted();
        ledger.fused();
      }
      if (rng.below(4) != 0) continue;
      ledger.probe_status(truth);
      settled_since_status = 0;
    }
    const BurstCounts counts = ledger.counts();
    EXPECT_LE(counts.captured, truth.begun) << life;
    EXPECT_GE(counts.captured + settled_since_status + 1, truth.begun) << "what it gave up unseen nobody can know";
    EXPECT_EQ(counts.captured, counts.incomplete + counts.accepted) << life;
  }
}

TEST(LossLedger, shows_gaps_before_the_final_status) {
  LossLedger ledger;
  ledger.received(0);
  ledger.received(1);
  ledger.received(4);
  EXPECT_EQ(ledger.sequence_gaps(), 2U);
}

}  // namespace
}  // namespace enamel::host
