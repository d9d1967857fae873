// Which stage sets the rate. By the utilisation law (Denning and Buzen 1978) it is the one that is busy the largest
// share of the time, or the workers where all of them are busy for longer than any stage; and nobody where the sources
// wait for bursts.
#pragma once

#include <string>
#include <vector>

#include "pipeline/flow/graph.hpp"

namespace enamel::flow {

/// One stage's part in the run; shares are 0…1 of the time since the run began.
struct StageLoad {
  std::string name;
  double rate_hz = 0;  ///< bursts that left it
  double busy = 0, waits_input = 0, waits_room = 0, waits_worker = 0;
  std::string waits_for;  ///< what takes the largest of the three shares: "decode0", "room in track", "a worker"
  std::uint64_t queue_depth = 0, queue_high_water = 0, queue_capacity = 0;  ///< of its lossless inputs, feedback apart
};

/// In the order of the snapshot's stages.
[[nodiscard]] std::vector<StageLoad> loads_of(const GraphSnapshot& snapshot);

struct Bottleneck {
  std::string stage;  ///< its name (of replicas: their family's), "workers", or empty: bursts come slower than they
                      ///< could be worked off
  std::string words;  ///< one line that says so
};

[[nodiscard]] Bottleneck bottleneck_of(const GraphSnapshot& snapshot);

}  // namespace enamel::flow
