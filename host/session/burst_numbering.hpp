// Burst numbers that stay unique when the probe is restarted within a session.
#pragma once

#include <cstdint>
#include <optional>

#include "protocol/types/burst.hpp"

namespace enamel::host {

/// The probe counts from zero in each of its lives; a burst_seq or burst_index that does not grow begins a new one,
/// whose numbers follow the last number given. Depends on the accepted bursts in their order alone, so live and replay
/// agree.
class BurstNumbering {
 public:
  /// Strictly increasing.
  [[nodiscard]] BurstId number(const proto::Burst& burst) noexcept {
    const bool new_life = last_ && (burst.burst_seq <= last_->seq || burst.burst_index <= last_->index);
    if (new_life) offset_ = last_->id + 1 - burst.burst_index;
    last_ = Last{burst.burst_seq, burst.burst_index, offset_ + burst.burst_index};
    return {last_->id};
  }

 private:
  struct Last {
    std::uint64_t seq, index, id;
  };
  std::optional<Last> last_;
  std::uint64_t offset_ = 0;  // wraps on purpose: only the sum counts
};

}  // namespace enamel::host
