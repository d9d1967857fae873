// The loss equation: where every burst that the probe began has gone.
//   captured = lost_on_wire + incomplete + shed + accepted        accepted = fused + sum(rejected)
// The probe counts its side (ProbeCounts, from Status), the host its own; the equation compares the two, so a burst
// that vanishes without a counter on either side is noticed.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "protocol/base/result.hpp"

namespace enamel::host {

/// What report.json holds under "bursts".
struct BurstCounts {
  std::uint64_t captured = 0;      ///< begun by the probe
  std::uint64_t lost_on_wire = 0;  ///< put on the wire, never arrived
  std::uint64_t incomplete = 0;    ///< assemblies given up by the probe, and payloads that arrived damaged
  std::uint64_t shed = 0;          ///< dropped on purpose: the probe's publisher queue and the host's ingress
  std::uint64_t accepted = 0;      ///< entered the stage graph
  std::uint64_t fused = 0;
  std::map<std::string, std::uint64_t> rejected;  ///< by reason

  [[nodiscard]] std::uint64_t rejected_total() const;
};

/// Errors: kAccounting when an equation fails, kDataLoss when lost_on_wire + incomplete > 0. Shedding alone is no
/// error.
[[nodiscard]] Result<void> check(const BurstCounts& counts);

/// One life of the probe process, as its Status tells.
struct ProbeCounts {
  std::uint64_t begun = 0;
  std::uint64_t emitted = 0;     ///< written to DDS
  std::uint64_t given_up = 0;    ///< assemblies aborted, all reasons but the queue
  std::uint64_t queue_full = 0;  ///< shed by the publisher's queue
};

/// Collects both sides. One writer thread. A probe that is restarted within a session begins a new life: its counters
/// start at zero again and are added to those of the lives before.
class LossLedger {
 public:
  void probe_status(const ProbeCounts& counts);
  void probe_restarted();

  void received(std::uint64_t burst_seq);  ///< a sample arrived, whole or not
  void received_unreadable();              ///< one arrived that does not even tell its number
  void damaged() { ++damaged_; }
  void shed() { ++host_shed_; }
  void accepted() { ++accepted_; }
  void fused() { ++fused_; }
  void rejected(const std::string& reason) { ++rejected_[reason]; }

  /// Holes in burst_seq seen so far: loss on the wire before the probe's final status is known.
  [[nodiscard]] std::uint64_t sequence_gaps() const;
  [[nodiscard]] BurstCounts counts() const;

 private:
  struct Life {
    std::optional<ProbeCounts> status;
    std::uint64_t received = 0;
    std::optional<std::uint64_t> first_seq, last_seq;
  };
  [[nodiscard]] static ProbeCounts counts_of(const Life& life);

  std::map<int, Life> lives_;
  int life_ = 0;
  std::uint64_t damaged_ = 0, host_shed_ = 0, accepted_ = 0, fused_ = 0;
  std::map<std::string, std::uint64_t> rejected_;
};

}  // namespace enamel::host
