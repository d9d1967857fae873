#include "host/desktop/take_counts.hpp"

#include <fmt/format.h>

namespace enamel::host {

TakeCounts take_counts(const BurstCounts& ledger, std::uint64_t moving, std::uint64_t spare) {
  TakeCounts c;
  c.captured = ledger.captured;
  c.taken = ledger.accepted;
  c.moving = moving;
  c.spare = spare;
  // What the probe's own queue let go never left it.
  const std::uint64_t shed_by_probe = ledger.shed >= moving + spare ? ledger.shed - moving - spare : 0;
  c.incomplete = ledger.incomplete + shed_by_probe;
  c.lost = ledger.lost_on_wire;
  return c;
}

Result<void> check(const TakeCounts& c) {
  if (c.captured != c.taken + c.moving + c.spare + c.incomplete + c.lost) {
    return fail(ErrorCode::kAccounting,
                fmt::format("captured {} is not taken {} + moving {} + spare {} + incomplete {} + lost {}", c.captured,
                            c.taken, c.moving, c.spare, c.incomplete, c.lost));
  }
  if (c.incomplete + c.lost > 0) {
    return fail(ErrorCode::kDataLoss,
                fmt::format("{} bursts lost on the wire, {} incomplete, of {}", c.lost, c.incomplete, c.captured));
  }
  return {};
}

}  // namespace enamel::host
