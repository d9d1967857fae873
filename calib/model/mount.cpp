#include "calib/model/mount.hpp"

#include <algorithm>

namespace enamel::calib {
namespace {

double dot(const Triple& a, const Triple& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Triple at(const AxisLine& line, double along_mm) {
  Triple p = nearest_to_origin(line);
  for (std::size_t i = 0; i < 3; ++i) p[i] += along_mm * line.direction[i];
  return p;
}

double distance_mm(const AxisLine& line, const Triple& p) {
  const Triple q{p[0] - line.point_mm[0], p[1] - line.point_mm[1], p[2] - line.point_mm[2]};
  const double along = dot(q, line.direction);
  return std::sqrt(std::max(0.0, dot(q, q) - along * along));
}

double angle_of(const AxisLine& line, double read_rad, double correction_rad) {
  return true_angle(read_rad, correction_rad, line.harmonic_rad[0], line.harmonic_rad[1]);
}

}  // namespace

Matrix4 table_motion(const Mount& mount, const AxisAngles& angles, const StopCorrection& correction) {
  const double rotation = angle_of(mount.rotation, angles.rotation(), correction.rotation_rad);
  const double swing = angle_of(mount.swing, angles.swing(), correction.swing_rad);
  const auto moved = [&](const Triple& p) {
    const Triple on_table = turned(mount.rotation.direction, mount.rotation.point_mm, rotation, p);
    return turned(mount.swing.direction, mount.swing.point_mm, swing, on_table);
  };
  const Triple origin = moved({0, 0, 0});
  Matrix4 out{};
  for (std::size_t c = 0; c < 3; ++c) {
    Triple unit{};
    unit[c] = 1;
    const Triple end = moved(unit);
    for (std::size_t r = 0; r < 3; ++r) out[r][c] = end[r] - origin[r];
  }
  for (std::size_t r = 0; r < 3; ++r) out[r][3] = origin[r];
  out[3][3] = 1;
  return out;
}

Triple nearest_to_origin(const AxisLine& line) {
  const double along = dot(line.point_mm, line.direction);
  Triple p = line.point_mm;
  for (std::size_t i = 0; i < 3; ++i) p[i] -= along * line.direction[i];
  return p;
}

LineDifference compare_lines(const AxisLine& a, const AxisLine& b, const Triple& about_mm, double reach_mm) {
  const Triple &d = a.direction, &e = b.direction;
  const Triple cross{d[1] * e[2] - d[2] * e[1], d[2] * e[0] - d[0] * e[2], d[0] * e[1] - d[1] * e[0]};
  const double middle = dot(about_mm, a.direction);
  return {std::atan2(std::sqrt(dot(cross, cross)), dot(d, e)),
          std::max(distance_mm(b, at(a, middle - reach_mm)), distance_mm(b, at(a, middle + reach_mm)))};
}

std::array<const char*, kMountParameters> mount_parameter_names() {
  return {"rotation.direction.x", "rotation.direction.y", "rotation.direction.z",  "rotation.point_mm.x",
          "rotation.point_mm.y",  "rotation.point_mm.z",  "rotation.harmonic.cos", "rotation.harmonic.sin",
          "swing.direction.x",    "swing.direction.y",    "swing.direction.z",     "swing.point_mm.x",
          "swing.point_mm.y",     "swing.point_mm.z",     "swing.harmonic.cos",    "swing.harmonic.sin"};
}

}  // namespace enamel::calib
