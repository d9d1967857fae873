// How the optics drift with the probe's temperature: straight lines about the temperature of the calibration. Pure
// functions, thread-safe.
#pragma once

#include <array>
#include <optional>

namespace enamel::calib {

struct Rig;

struct LensDrift {
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< px a kelvin
};

/// Terms a kelvin about `reference_c`, valid in `range_c`. The relative pose turns by `rotation_rad` (a rotation vector
/// in projector coordinates, applied after T_proj_cam's rotation) and shifts by `translation_mm`.
struct TemperatureTerms {
  double reference_c = 0;
  std::array<double, 2> range_c{};
  LensDrift camera, projector;
  std::array<double, 3> rotation_rad{}, translation_mm{};
};

/// The rig at a temperature, degrees Celsius, held at the ends of `range_c`; `rig` itself without terms. The text and
/// its CRC stay those of the file.
[[nodiscard]] Rig rig_at(const Rig& rig, double temp_c);

/// Kelvins by which a temperature lies outside of what the calibration covers: outside `range_c` with terms, away from
/// the calibration's own temp_c without; empty when the file states neither.
[[nodiscard]] std::optional<double> kelvins_beyond(const Rig& rig, double temp_c);

}  // namespace enamel::calib
