// The table's axes as the commands name them: a port, and perhaps a profile.
#pragma once

#include <memory>
#include <string>

#include "host/motion/grbl_axes.hpp"

namespace enamel::app {

/// Nothing moves. profile: path; empty: the values of config/desktop/grbl.toml. Errors: of read_grbl_profile and
/// GrblAxes::open.
[[nodiscard]] Result<std::unique_ptr<motion::GrblAxes>> open_axes(const std::string& port, const std::string& profile,
                                                                  Clock& clock);

/// Of options, which people give in seconds.
[[nodiscard]] Nanoseconds nanoseconds(double seconds);

}  // namespace enamel::app
