// The probe's side of the loss equation, read from its Status.
#pragma once

#include "host/report/accounting.hpp"
#include "protocol/types/device.hpp"

namespace enamel::host {

/// A burst that the publisher's queue let go is shed; every other reason means that its assembly was given up.
[[nodiscard]] inline ProbeCounts counts_of(const proto::Status& status) {
  constexpr auto kQueue = static_cast<std::size_t>(proto::DropReason::kQueueFull);
  ProbeCounts counts{status.bursts_begun, status.bursts_emitted, 0, status.dropped[kQueue]};
  for (std::size_t i = 0; i < status.dropped.size(); ++i) {
    if (i != kQueue) counts.given_up += status.dropped[i];
  }
  return counts;
}

}  // namespace enamel::host
