// A desktop mount as a scene file states it: a table that turns on a cradle that swings, before a head that stands.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace enamel::twin {

/// From which side an axis arrives at a stop.
enum class Approach : std::uint8_t {
  kPositive,  ///< always with rising angle: the play of the gear stays on one side
  kNearest,   ///< straight from where it is: with falling angle the table lags by the backlash
};

struct AxisConfig {
  std::array<double, 3> direction{0, 0,
                                  -1};       ///< camera frame, any length; positive angles turn right-handedly about it
  std::array<double, 3> point_mm{0, 0, 48};  ///< any point of the line, camera frame
  std::array<double, 3> tilt_deg{};          ///< rotation vector that turns `direction`, camera frame
  std::array<double, 2> harmonic_deg{};      ///< hc, hs of hc (cos a - 1) + hs sin a
  double backlash_deg = 0;
  Approach approach = Approach::kPositive;
  double stop_error_deg = 0;  ///< rms of where the drive stops; an axis that does not move keeps its error
  bool has_encoder = false;
  double encoder_noise_deg = 0.002;  ///< rms of a reading
};

/// Commanded angles.
struct MountStop {
  double rot_deg = 0, swing_deg = 0;
};

struct MountConfig {
  AxisConfig rotation{.point_mm = {27, 0, 48}};  ///< at swing 0
  AxisConfig swing{.direction = {0, 1, 0}};
  double skew_mm = 0;                ///< moves the swing axis along rotation x swing
  double wobble_um = 0;              ///< peak of the table's run-out, an axis
  bool draw = false;                 ///< errors of one unit by the seed, on top of what is stated
  std::array<double, 3> place_mm{};  ///< of the model's origin on the table
  double place_turn_deg = 0;         ///< of the model, about the table's z axis
  int bursts = 1;                    ///< at each stop
  double move_s = 0.5;               ///< from stop to stop; the probe is paused
  std::vector<MountStop> stops;      ///< in the order of the drive
};

}  // namespace enamel::twin
