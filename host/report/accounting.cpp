#include "host/report/accounting.hpp"

#include <algorithm>

namespace enamel::host {

std::uint64_t BurstCounts::rejected_total() const {
  std::uint64_t sum = 0;
  for (const auto& [reason, count] : rejected) sum += count;
  return sum;
}

Result<void> check(const BurstCounts& c) {
  const std::uint64_t wire_sum = c.lost_on_wire + c.incomplete + c.shed + c.accepted;
  if (c.captured != wire_sum) {
    return fail(ErrorCode::kAccounting, "captured " + std::to_string(c.captured) + " is not lost_on_wire " +
                                            std::to_string(c.lost_on_wire) + " + incomplete " +
                                            std::to_string(c.incomplete) + " + shed " + std::to_string(c.shed) +
                                            " + accepted " + std::to_string(c.accepted));
  }
  if (c.accepted != c.fused + c.rejected_total()) {
    return fail(ErrorCode::kAccounting, "accepted " + std::to_string(c.accepted) + " is not fused " +
                                            std::to_string(c.fused) + " + rejected " +
                                            std::to_string(c.rejected_total()));
  }
  if (c.lost_on_wire + c.incomplete > 0) {
    return fail(ErrorCode::kDataLoss, std::to_string(c.lost_on_wire) + " bursts lost on the wire, " +
                                          std::to_string(c.incomplete) + " incomplete, of " +
                                          std::to_string(c.captured));
  }
  return {};
}

void LossLedger::probe_status(const ProbeCounts& counts) { lives_[life_].status = counts; }

void LossLedger::probe_restarted() { ++life_; }

void LossLedger::received(std::uint64_t burst_seq) {
  Life& life = lives_[life_];
  ++life.received;
  life.first_seq = std::min(life.first_seq.value_or(burst_seq), burst_seq);
  life.last_seq = std::max(life.last_seq.value_or(burst_seq), burst_seq);
}

void LossLedger::received_unreadable() { ++lives_[life_].received; }

std::uint64_t LossLedger::sequence_gaps() const {
  std::uint64_t gaps = 0;
  for (const auto& [number, life] : lives_) {
    if (!life.first_seq) continue;
    const std::uint64_t spanned = *life.last_seq - *life.first_seq + 1;
    if (spanned > life.received) gaps += spanned - life.received;
  }
  return gaps;
}

// A probe that died cannot say how many bursts it began after its last status; what arrived since proves that many.
ProbeCounts LossLedger::counts_of(const Life& life) {
  ProbeCounts counts = life.status.value_or(ProbeCounts{});
  const std::uint64_t spanned = life.last_seq ? *life.last_seq + 1 - (life.status ? 0 : *life.first_seq) : 0;
  // Damaged ones arrived too, and may lie before the first or behind the last that tells its number.
  const std::uint64_t proven = std::max(spanned, life.received);
  counts.emitted = std::max(counts.emitted, proven);
  // What the last status had begun but not yet settled is among those that arrived since, or was never finished.
  const std::uint64_t settled = counts.emitted + counts.given_up + counts.queue_full;
  counts.begun = std::max(counts.begun, settled);
  counts.given_up += counts.begun - settled;
  return counts;
}

BurstCounts LossLedger::counts() const {
  BurstCounts c;
  c.incomplete = damaged_;
  c.shed = host_shed_;
  c.accepted = accepted_;
  c.fused = fused_;
  c.rejected = rejected_;
  for (const auto& [number, life] : lives_) {
    const ProbeCounts probe = counts_of(life);
    c.captured += probe.begun;
    c.incomplete += probe.given_up;
    c.shed += probe.queue_full;
    c.lost_on_wire += probe.emitted >= life.received ? probe.emitted - life.received : 0;
  }
  return c;
}

}  // namespace enamel::host
