// Burst numbers that stay unique when the probe is restarted within a session.
#pragma once

#include <cstdint>
#include <optional>

#include "protocol/types/burst.hpp"

namespace enamel::host {

/// The probe counts from zero in each of its lives; a burst_seq that does not grow begins a new one, whose numbers follow
/// the last number given. Depends on the accepted bursts in their order alone, so live and replay agree.
class BurstNumbering {
 public:
  [[nodiscard]] BurstId number(const proto::Burst& burst) noexcept {
    if (last_seq_ && burst.burst_seq <= *last_seq_) offset_ = last_id_ + 1 - burst.burst_index;
    last_seq_ = burst.burst_seq;
    last_id_ = offset_ + burst.burst_index;
    return {last_id_};
  }

 private:
  std::optional<std::uint64_t> last_seq_;
  std::uint64_t offset_ = 0;  // wraps on purpose: only the sum counts
  std::uint64_t last_id_ = 0;
};

}  // namespace enamel::host
