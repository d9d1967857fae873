#include "host/app/desktop/open_axes.hpp"

namespace enamel::app {

Result<std::unique_ptr<motion::GrblAxes>> open_axes(const std::string& port, const std::string& profile, Clock& clock) {
  motion::GrblProfile chosen;
  if (!profile.empty()) {
    ENAMEL_TRY_ASSIGN(chosen, motion::read_grbl_profile(profile));
  }
  return motion::GrblAxes::open(port, chosen, clock);
}

Nanoseconds nanoseconds(double seconds) { return Nanoseconds{static_cast<std::int64_t>(seconds * 1e9)}; }

}  // namespace enamel::app
