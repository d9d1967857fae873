// What is wrong with a set of stops: too few, too narrow, a wrong one, a table that slips. Private to calib/mount.
#pragma once

#include <optional>

#include "calib/mount/adjust.hpp"

namespace enamel::calib {

/// At least 12 angles of the table over 180 degrees and 5 of the cradle over 20. Error: kCalibrationPoses with what
/// there is and what it takes.
[[nodiscard]] Result<void> check_stops(const std::vector<MountStop>& stops);

/// A table that slips: the axis' angle beyond the read one, as a line over the stops' order beside a first harmonic,
/// runs away by more than two priors and six of its standard deviations. Error: kCalibrationRefused with axis and
/// degrees a stop.
[[nodiscard]] Result<void> check_slip(const std::vector<MountStop>& stops, const Adjusted& adjusted,
                                      const MountOptions& options);

struct WrongStop {
  std::size_t stop = 0;
  std::string reason;
};

/// The stop whose correction is the largest, if that is gross.
[[nodiscard]] std::optional<WrongStop> worst_stop(const Adjusted& adjusted, const MountOptions& options);

}  // namespace enamel::calib
