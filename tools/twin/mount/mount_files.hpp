// What a mount leaves beside its pictures: axes.csv, which the host reads, and the truth.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "tools/twin/mount/mount.hpp"

namespace enamel::twin {

/// axes.csv: one row a burst or pose, degrees, `key` ("burst_id" or "pose") in front. An axis without an encoder has
/// `nan` in the place of its reading; one with an encoder is read anew for every row. Precondition: run is of config
/// and seed.
struct AxesTable {
  std::string_view key;
  std::uint64_t rows = 0;
  int rows_a_stop = 1;
};
[[nodiscard]] std::string axes_csv(const MountRun& run, const MountConfig& config, std::uint64_t seed,
                                   const AxesTable& table);

/// truth/mount_true.json: the serial of the rig whose frame it is in, the axes as mount.json states them (each point
/// the one nearest to the camera), pose of table and model at both angles 0, and at every stop the true angles, parts
/// of them, and the run-out.
[[nodiscard]] std::string mount_true_json(const MountRun& run, int bursts_a_stop, std::string_view serial);

}  // namespace enamel::twin
