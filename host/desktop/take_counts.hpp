// Where every burst of a desktop scan has gone.
//   captured = taken + moving + spare + incomplete + lost
#pragma once

#include <cstdint>

#include "host/report/accounting.hpp"
#include "protocol/base/result.hpp"

namespace enamel::host {

struct TakeCounts {
  std::uint64_t captured = 0;    ///< begun by the probe
  std::uint64_t taken = 0;       ///< of a stop
  std::uint64_t moving = 0;      ///< arrived whole, but the table moved
  std::uint64_t spare = 0;       ///< arrived whole from a table at rest whose stop needed no more, or was given up
  std::uint64_t incomplete = 0;  ///< given up or shed by the probe, or arrived damaged
  std::uint64_t lost = 0;        ///< put on the wire, never arrived
};

/// From the ledger's: there `moving` and `spare` are what the host shed, and nothing is fused or rejected.
[[nodiscard]] TakeCounts take_counts(const BurstCounts& ledger, std::uint64_t moving, std::uint64_t spare);

/// kAccounting when the equation fails, kDataLoss when incomplete + lost > 0.
[[nodiscard]] Result<void> check(const TakeCounts& counts);

}  // namespace enamel::host
