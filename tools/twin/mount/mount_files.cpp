#include "tools/twin/mount/mount_files.hpp"

#include <spdlog/fmt/fmt.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "protocol/base/json_text.hpp"
#include "tools/twin/degrees.hpp"
#include "tools/twin/mount/mount_path.hpp"
#include "tools/twin/optics/random.hpp"

namespace enamel::twin {
namespace {

using MountJson = nlohmann::ordered_json;

constexpr std::uint64_t kRotReadStream = 7310, kSwingReadStream = 7311;  // of the random numbers

double in_degrees(double rad) { return rad / kRadPerDeg; }

MountJson list(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

MountJson rows_of(const Eigen::Isometry3d& T) {
  MountJson rows = MountJson::array();
  for (int r = 0; r < 4; ++r) rows.push_back({T.matrix()(r, 0), T.matrix()(r, 1), T.matrix()(r, 2), T.matrix()(r, 3)});
  return rows;
}

MountJson axis_json(const Axis& axis) {
  const Eigen::Vector3d nearest = axis.point_mm - axis.direction * axis.direction.dot(axis.point_mm);
  return {{"direction", list(axis.direction)},
          {"point_mm", list(nearest)},
          {"harmonic_deg", {in_degrees(axis.harmonic_rad[0]), in_degrees(axis.harmonic_rad[1])}},
          {"backlash_deg", in_degrees(axis.backlash_rad)},
          {"approach", axis.approach == Approach::kPositive ? "positive" : "nearest"}};
}

double reading_deg(double shaft_rad, const AxisConfig& axis, const CounterRandom& random, std::uint64_t row) {
  if (!axis.has_encoder) return std::numeric_limits<double>::quiet_NaN();
  return in_degrees(shaft_rad) + axis.encoder_noise_deg * random.normals(row).a;
}

}  // namespace

std::string axes_csv(const MountRun& run, const MountConfig& config, std::uint64_t seed, const AxesTable& table) {
  const CounterRandom rot_noise(seed, kRotReadStream), swing_noise(seed, kSwingReadStream);
  std::string out = fmt::format("{},rot_cmd_deg,swing_cmd_deg,rot_read_deg,swing_read_deg\n", table.key);
  for (std::uint64_t n = 0; n < table.rows; ++n) {
    const StopTruth& stop = run.stops[stop_of(n, table.rows_a_stop, run.stops.size())];
    out += fmt::format("{},{:.6f},{:.6f},{:.6f},{:.6f}\n", n, in_degrees(stop.rot_cmd), in_degrees(stop.swing_cmd),
                       reading_deg(stop.rot_shaft, config.rotation, rot_noise, n),
                       reading_deg(stop.swing_shaft, config.swing, swing_noise, n));
  }
  return out;
}

std::string mount_true_json(const MountRun& run, int bursts_a_stop, std::string_view serial) {
  MountJson stops = MountJson::array();
  for (std::size_t i = 0; i < run.stops.size(); ++i) {
    const StopTruth& s = run.stops[i];
    stops.push_back({{"stop", i},
                     {"rot_cmd_deg", in_degrees(s.rot_cmd)},
                     {"swing_cmd_deg", in_degrees(s.swing_cmd)},
                     {"rot_shaft_deg", in_degrees(s.rot_shaft)},
                     {"swing_shaft_deg", in_degrees(s.swing_shaft)},
                     {"rot_true_deg", in_degrees(s.rot)},
                     {"swing_true_deg", in_degrees(s.swing)},
                     {"run_out_um", list(s.run_out_mm / kMmPerUm)}});
  }
  const MountJson json{{"format", "enamel-mount-truth"},
                       {"schema", 1},
                       {"serial", serial},
                       {"rotation", axis_json(run.mount.rotation)},
                       {"swing", axis_json(run.mount.swing)},
                       {"wobble_um", run.mount.wobble_mm / kMmPerUm},
                       {"bursts_a_stop", bursts_a_stop},
                       {"T_camera_table", rows_of(run.mount.T_camera_table)},
                       {"T_table_model", rows_of(run.mount.T_table_model)},
                       {"stops", stops}};
  return json_text(json, 1) + "\n";
}

}  // namespace enamel::twin
