// The desktop scanner's mount: a table that turns on a cradle that swings, in front of a head that stands still. Two
// lines in the camera frame of the rig (+x right, +y down, +z out), given at swing = 0; the rotation axis goes along
// with the cradle. Units mm and rad; degrees stand in files only. Plain numbers and pure functions, thread-safe.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/base/result.hpp"

namespace enamel::calib {

inline constexpr double kRadPerDegree = std::numbers::pi / 180;  ///< files and tables have degrees
inline constexpr double kDegreesPerRad = 180 / std::numbers::pi;

using Triple = std::array<double, 3>;
using Matrix4 = std::array<std::array<double, 4>, 4>;  ///< row major

/// One axis. Positive angles turn right-handedly about `direction`. The axis' true angle at the read angle a is
/// a + harmonic[0] (cos a - 1) + harmonic[1] sin a.
struct AxisLine {
  Triple direction{0, 0, 1};  ///< unit vector
  Triple point_mm{};          ///< any point of the line; as solved, the one nearest to the camera's origin
  std::array<double, 2> harmonic_rad{};
  double backlash_rad = 0;  ///< play of the drive, 0 where every stop was approached from one side
  int approach = 1;         ///< +1: stops are approached by rising angles; -1: by falling ones
};

/// Angle of a stop beyond what the model says, found when the mount was calibrated.
struct StopCorrection {
  std::string pose;
  double rotation_rad = 0, swing_rad = 0;
};

/// Of the file's numbers in the order of mount_parameter_names(); empty when unknown. The point's variance along the
/// line and the direction's along itself are zero.
struct MountCovariance {
  std::vector<std::string> parameters;
  std::vector<double> matrix;  ///< row major, parameters.size() squared; mm, rad
};

struct Mount {
  std::string serial;         ///< of the scanner
  std::string calibrated_at;  ///< UTC, ISO 8601; empty: design or truth
  AxisLine rotation, swing;
  std::vector<StopCorrection> stop_corrections;
  MountCovariance covariance;
};

/// Angles of a stop, rad. NaN: not read.
struct AxisAngles {
  double rotation_command = 0, swing_command = 0;
  double rotation_read = std::numeric_limits<double>::quiet_NaN();
  double swing_read = std::numeric_limits<double>::quiet_NaN();

  /// What was read where anything was read, else what was commanded.
  [[nodiscard]] double rotation() const noexcept {
    return std::isnan(rotation_read) ? rotation_command : rotation_read;
  }
  [[nodiscard]] double swing() const noexcept { return std::isnan(swing_read) ? swing_command : swing_read; }
};

/// The axis' angle for an angle read and a correction of its stop. T: double or a type with derivatives.
template <class T>
[[nodiscard]] T true_angle(double read_rad, const T& correction_rad, const T& cosine_rad, const T& sine_rad) {
  return read_rad + correction_rad + cosine_rad * (std::cos(read_rad) - 1.0) + sine_rad * std::sin(read_rad);
}

/// `p` turned by `angle` about the line through `point` along the unit vector `direction` (Rodrigues 1840).
template <class T>
[[nodiscard]] std::array<T, 3> turned(const std::array<T, 3>& direction, const std::array<T, 3>& point, const T& angle,
                                      const std::array<T, 3>& p) {
  using std::cos;
  using std::sin;
  const std::array<T, 3>& d = direction;
  const std::array<T, 3> q{p[0] - point[0], p[1] - point[1], p[2] - point[2]};
  const std::array<T, 3> cross{d[1] * q[2] - d[2] * q[1], d[2] * q[0] - d[0] * q[2], d[0] * q[1] - d[1] * q[0]};
  const T c = cos(angle), s = sin(angle), along = (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) * (1.0 - c);
  std::array<T, 3> out;
  for (std::size_t i = 0; i < 3; ++i) out[i] = point[i] + q[i] * c + cross[i] * s + d[i] * along;
  return out;
}

/// Motion of the table since both angles were 0: T_camera_table(a, b) = table_motion(a, b) T_camera_table(0, 0), with
/// table_motion = Rot(swing; b') Rot(rotation; a').
[[nodiscard]] Matrix4 table_motion(const Mount& mount, const AxisAngles& angles, const StopCorrection& correction = {});

/// The point of the line that is nearest to the camera's origin.
[[nodiscard]] Triple nearest_to_origin(const AxisLine& line);

/// How two lines differ: angle between their directions, and largest distance between them within `reach_mm` of
/// `about`: there the table's surface is seen.
struct LineDifference {
  double angle_rad = 0, distance_mm = 0;
};
[[nodiscard]] LineDifference compare_lines(const AxisLine& a, const AxisLine& b, const Triple& about_mm,
                                           double reach_mm);

/// Names of the covariance's rows: direction, point and harmonic of rotation, then of swing.
inline constexpr std::size_t kMountParameters = 16;
[[nodiscard]] std::array<const char*, kMountParameters> mount_parameter_names();

/// Reads mount.json (format enamel-mount, schema 1) and the twin's enamel-mount-truth, whose serial may be absent. Keys
/// that this version does not know are passed over. Error: kMountInvalid, the detail names the key and what it must be;
/// never a partial mount.
[[nodiscard]] Result<Mount> parse_mount(std::string_view text);

/// Errors: kFileNotFound, kFileRead, those of parse_mount with the file's name.
[[nodiscard]] Result<Mount> load_mount(const std::string& path);

/// mount.json, sealed by its own SHA-256 (key sha256, taken with that key empty).
/// Error: kMountInvalid for what parse_mount would refuse.
[[nodiscard]] Result<std::string> mount_text(const Mount& mount);

/// Whether `text` is of one of the two formats, whatever else is wrong with it.
[[nodiscard]] bool is_mount_text(std::string_view text);

}  // namespace enamel::calib
