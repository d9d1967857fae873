#include "tools/twin/scene/mount_keys.hpp"

#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "tools/twin/degrees.hpp"
#include "tools/twin/mount/mount.hpp"

namespace enamel::twin {
namespace {

using Names = std::string_view;
constexpr std::array<std::pair<Names, Approach>, 2> kApproaches{
    {{"positive", Approach::kPositive}, {"nearest", Approach::kNearest}}};
constexpr std::size_t kMaxStops = 10000;
constexpr double kMinAngle_deg = 10;  // between the axes

void bind_axis(ConfigReader r, AxisConfig& a) {
  r.bind("direction", a.direction, {-1000, 1000}, "of the axis, camera frame, any length; angles are right-handed");
  r.bind("point_mm", a.point_mm, {-1000, 1000}, "a point of the axis, camera frame");
  r.bind("tilt_deg", a.tilt_deg, {-90, 90}, "rotation vector that turns the direction, camera frame");
  r.bind("harmonic_deg", a.harmonic_deg, {-5, 5}, "c, s: the table turns by a + c (cos a - 1) + s sin a");
  r.bind("backlash_deg", a.backlash_deg, {0, 5}, "the table lags by so much behind a falling angle");
  r.bind("approach", a.approach, kApproaches, "positive: always from below; nearest: straight, with backlash");
  r.bind("stop_error_deg", a.stop_error_deg, {0, 20}, "rms of where the drive stops");
  r.bind("encoder", a.has_encoder, "the shaft's angle is read; off: axes.csv has nan");
  r.bind("encoder_noise_deg", a.encoder_noise_deg, {0, 5}, "rms of a reading");
  if (a.direction == std::array<double, 3>{}) r.reject("direction", "is no direction");
}

/// A list of angles, or {from, to, step} with both ends.
std::vector<double> bind_angles(ConfigReader& r, const std::string& key, double limit_deg) {
  std::vector<double> out;
  if (!r.has(key + ".from") && !r.has(key + ".to") && !r.has(key + ".step")) {
    r.bind(key, out, {-limit_deg, limit_deg}, "commanded angles of the stops, or {from, to, step}");
    return out;
  }
  double from = 0, to = 0, step = 0;
  ConfigReader range = r.table(key);
  range.bind("from", from, {-limit_deg, limit_deg}, "first angle");
  range.bind("to", to, {-limit_deg, limit_deg}, "last angle, if a step leads to it");
  range.bind("step", step, {-limit_deg, limit_deg}, "from stop to stop");
  if (step == 0) {
    range.reject("step", "is 0 or not given: no way from stop to stop");
    return out;
  }
  constexpr double kRounding = 1e-9;  // of steps
  const double last = std::floor((to - from) / step + kRounding);
  if (last < 0) {
    range.reject("step", "leads away from `to`: it needs the other sign");
  } else if (last >= kMaxStops) {
    range.reject("step", "makes more than " + std::to_string(kMaxStops) + " stops");
  } else {
    for (int i = 0; i <= static_cast<int>(last); ++i) out.push_back(from + i * step);
  }
  return out;
}

/// The whole grid, rotation inside, then single stops.
void bind_stops(ConfigReader& r, MountConfig& m) {
  const std::vector<double> rot = bind_angles(r, "rot_deg", 3600), swing = bind_angles(r, "swing_deg", 90);
  const std::size_t grid = rot.size() * (r.has("swing_deg") ? swing.size() : 1);
  const std::size_t single = r.table_count("stop");
  if (grid + single > kMaxStops) {
    r.reject("rot_deg", "with swing_deg makes more than " + std::to_string(kMaxStops) + " stops");
    return;
  }
  m.stops.clear();
  for (const double s : r.has("swing_deg") ? swing : std::vector<double>{0}) {
    for (const double a : rot) m.stops.push_back({a, s});
  }
  for (std::size_t i = 0; i < single; ++i) {
    MountStop stop;
    ConfigReader each = r.table("stop", i);
    each.bind("rot_deg", stop.rot_deg, {-3600, 3600}, "commanded angle");
    each.bind("swing_deg", stop.swing_deg, {-90, 90}, "commanded angle");
    m.stops.push_back(stop);
  }
}

void check_axes(ConfigReader& r, const MountConfig& m) {
  const double sine = stated_direction(m.rotation).cross(stated_direction(m.swing)).norm();
  if (sine < std::sin(kMinAngle_deg * kRadPerDeg)) {
    r.reject("swing.direction", "is within 10 degrees of the rotation axis: a mount needs two axes");
  }
}

}  // namespace

void bind_mount(ConfigReader& reader, SceneConfig& c) {
  ConfigReader r = reader.table("mount");
  MountConfig& m = c.mount;
  bind_axis(r.table("rotation"), m.rotation);
  bind_axis(r.table("swing"), m.swing);
  r.bind("draw", m.draw,
         "tilt, skew, harmonics, backlash and wobble of one unit by the seed, on top of what is stated");
  r.bind("skew_mm", m.skew_mm, {-50, 50}, "moves the swing axis along rotation x swing");
  r.bind("wobble_um", m.wobble_um, {0, 1000}, "run-out of the table, peak an axis, twice a turn");
  r.bind("place_mm", m.place_mm, {-200, 200}, "of the model's origin on the table");
  r.bind("place_turn_deg", m.place_turn_deg, {-360, 360}, "of the model, about the table's z axis");
  r.bind("bursts", m.bursts, {1, 1000}, "at each stop");
  r.bind("move_s", m.move_s, {0, 60}, "from stop to stop; the probe is paused");
  bind_stops(r, m);
  check_axes(r, m);
  if (c.path == PathKind::kMount && m.stops.empty()) {
    r.reject("rot_deg", "path.type = mount needs stops: give rot_deg, or [[mount.stop]]");
  }
}

}  // namespace enamel::twin
