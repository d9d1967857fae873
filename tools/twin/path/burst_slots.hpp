// Which slots of the probe's rhythm carry a burst, when it is paused now and then.
#pragma once

#include <cstdint>
#include <vector>

namespace enamel::twin {

/// Slots without a burst: [first, end).
struct Quiet {
  std::int64_t first, end;
};

class BurstSlots {
 public:
  /// In any order, overlapping or not; slots before 0 do not count.
  explicit BurstSlots(std::vector<Quiet> quiet);
  [[nodiscard]] std::uint64_t slot(std::uint64_t burst) const;
  /// Bursts among the slots [0, slots).
  [[nodiscard]] int bursts_within(int slots) const;

 private:
  std::vector<Quiet> quiet_;  ///< rising, disjoint
};

}  // namespace enamel::twin
