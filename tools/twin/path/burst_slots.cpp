#include "tools/twin/path/burst_slots.hpp"

#include <algorithm>

namespace enamel::twin {

BurstSlots::BurstSlots(std::vector<Quiet> quiet) {
  std::sort(quiet.begin(), quiet.end(), [](const Quiet& a, const Quiet& b) { return a.first < b.first; });
  std::int64_t free_from = 0;
  for (const Quiet& q : quiet) {
    const std::int64_t first = std::max(q.first, free_from);
    if (q.end <= first) continue;
    quiet_.push_back({first, q.end});
    free_from = q.end;
  }
}

std::uint64_t BurstSlots::slot(std::uint64_t burst) const {
  auto slot = static_cast<std::int64_t>(burst);
  for (const Quiet& q : quiet_) {
    if (slot >= q.first) slot += q.end - q.first;
  }
  return static_cast<std::uint64_t>(slot);
}

int BurstSlots::bursts_within(int slots) const {
  std::int64_t bursts = slots;
  for (const Quiet& q : quiet_) bursts -= std::max<std::int64_t>(0, std::min<std::int64_t>(q.end, slots) - q.first);
  return static_cast<int>(bursts);
}

}  // namespace enamel::twin
