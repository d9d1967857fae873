// How a table hangs on its GRBL controller: which letter turns, which swings, steps, limits. A TOML file.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>

#include "host/motion/axes.hpp"

namespace enamel::motion {

struct GrblAxisConfig {
  std::string letter = "X";  ///< X, Y or Z
  double deg_per_unit =
      1.0;  ///< degrees of the table a unit of the controller; negative: the motor turns the other way
  double steps_per_deg = 800.0;  ///< motor steps a degree of the table, microsteps and gear included
  double min_deg = -1.0;         ///< travel: nothing is sent beyond it
  double max_deg = 361.0;
  double home_deg = 0.0;  ///< angle where the axis stands after $H, pulled off its switch
};

struct GrblProfile {
  GrblAxisConfig rot;
  GrblAxisConfig swing{.letter = "Y", .min_deg = -31.0, .max_deg = 31.0, .home_deg = -30.0};
  double feed_deg_per_s = 15.0;  ///< of the axis that goes further
  double overshoot_deg = 0.5;    ///< more than the backlash of either axis; 0: none
  double settle_ms = 300.0;      ///< from standing still to the first exposure
  double banner_ms = 2500.0;     ///< a controller that opening the port resets has spoken by then

  [[nodiscard]] AxesLimits travel() const { return {{rot.min_deg, rot.max_deg}, {swing.min_deg, swing.max_deg}}; }
};

/// 0, 1, 2 of X, Y, Z.
[[nodiscard]] std::size_t letter_index(const GrblAxisConfig& axis);

/// kFileNotFound, kFileRead, kConfigSyntax, kConfigUnknownKey, kConfigValue.
[[nodiscard]] Result<GrblProfile> read_grbl_profile(const std::filesystem::path& path);
[[nodiscard]] Result<GrblProfile> parse_grbl_profile(std::string_view text, std::string_view name);

using GrblSettings = std::map<int, double>;  ///< number of $n: value

/// Whether a controller with these settings moves the table that the profile describes; kConfigValue names every
/// setting that does not fit, with both numbers and the line to send.
[[nodiscard]] Result<void> check_settings(const GrblSettings& settings, const GrblProfile& profile);

/// From the controller's machine position of the home place to angles and back. Units: the controller's.
struct GrblScale {
  std::array<double, 2> home_units{};  ///< machine position of rotation and swing at home
  std::array<double, 2> home_deg{};
  std::array<double, 2> deg_per_unit{1.0, 1.0};

  [[nodiscard]] AxesAngles angles(const std::array<double, 2>& units) const;
  [[nodiscard]] std::array<double, 2> units(const AxesAngles& angles) const;
};

/// Whether the travel lies within the controller's soft limits, which reach from -$130 to 0; kConfigValue.
[[nodiscard]] Result<void> check_travel(const GrblSettings& settings, const GrblProfile& profile,
                                        const GrblScale& scale);

/// Feed in units a minute at which the axis that goes further keeps feed_deg_per_s; both points in degrees. 1 at least.
[[nodiscard]] double feed_units_per_min(const AxesAngles& from, const AxesAngles& to, const GrblProfile& profile);

}  // namespace enamel::motion
