// Scenes with a mount: keys, rhythm, and axes.csv and the truth beside what the renderer is given.
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/unit/twin/twin_fixture.hpp"
#include "tools/twin/board/board_stage.hpp"
#include "tools/twin/degrees.hpp"
#include "tools/twin/mount/mount_files.hpp"
#include "tools/twin/mount/mount_path.hpp"

namespace enamel::twin::testing {
namespace {

using Eigen::Vector3d;

Result<SceneConfig> parse_mount(const std::string& mount, const std::string& path = "mount") {
  auto reader = ConfigReader::from_text(
      "[object]\ntype='plane'\n[path]\ntype='" + path + "'\n[[path.view]]\n[mount]\n" + mount, "bench.toml");
  if (!reader) return tl::unexpected<Error>(reader.error());
  SceneConfig c;
  bind_scene(*reader, c);
  if (auto done = reader->finish(); !done) return tl::unexpected<Error>(done.error());
  return c;
}

void stops_refused(const std::string& mount, const std::string& key, const std::string& why) {
  const auto scene = parse_mount(mount);
  ASSERT_FALSE(scene) << mount;
  const std::string message = scene.error().message();
  EXPECT_NE(message.find("bench.toml"), std::string::npos) << message;
  EXPECT_NE(message.find("mount." + key), std::string::npos) << message;
  EXPECT_NE(message.find(why), std::string::npos) << message;
}

TEST(MountKeys, stops_are_a_grid_of_lists_or_ranges_and_single_ones) {
  const auto c =
      parse_mount("rot_deg={from=0,to=330,step=30}\nswing_deg=[-20,20]\n[[mount.stop]]\nrot_deg=7\nswing_deg=-3\n");
  ASSERT_TRUE(c) << c.error().message();
  const auto& stops = c->mount.stops;
  ASSERT_EQ(stops.size(), 25U);
  EXPECT_EQ(stops[11].rot_deg, 330);
  EXPECT_EQ(stops[11].swing_deg, -20);
  EXPECT_EQ(stops[12].rot_deg, 0);
  EXPECT_EQ(stops[12].swing_deg, 20);
  EXPECT_EQ(stops[24].rot_deg, 7);
  EXPECT_EQ(stops[24].swing_deg, -3);
  EXPECT_EQ(parse_mount("rot_deg={from=0,to=1,step=0.1}\n")->mount.stops.size(), 11U);
  EXPECT_EQ(parse_mount("rot_deg=[5]\nswing_deg={from=30,to=-30,step=-15}\n")->mount.stops.size(), 5U);
  EXPECT_EQ(parse_mount("rot_deg=[5]\n")->mount.stops.front().swing_deg, 0);
}

TEST(MountKeys, mistakes_are_named_with_file_and_key) {
  stops_refused("", "rot_deg", "needs stops");
  stops_refused("rot_deg=[]\n", "rot_deg", "needs stops");
  stops_refused("rot_deg={from=0,to=90}\n", "rot_deg.step", "no way from stop to stop");
  stops_refused("rot_deg={from=0,to=90,step=-5}\n", "rot_deg.step", "other sign");
  stops_refused("rot_deg={from=0,to=3600,step=0.001}\n", "rot_deg.step", "10000");
  stops_refused("rot_deg={from=0,to=360,step=1}\nswing_deg={from=-20,to=20,step=1}\n", "rot_deg", "10000");
  stops_refused("rot_deg=[0]\nswing_deg=[91]\n", "swing_deg", "90");
  stops_refused("rot_deg=[0]\nrotation.tild_deg=[0,0,0]\n", "rotation.tild_deg", "unknown");
  stops_refused("rot_deg=[0]\nrotation.direction=[0,0,0]\n", "rotation.direction", "no direction");
  stops_refused("rot_deg=[0]\nrotation.direction=[0,1,0.1]\n", "swing.direction", "two axes");
  stops_refused("rot_deg=[0]\nrotation.approach='left'\n", "rotation.approach", "positive");
  stops_refused("rot_deg=[0]\nbursts=0\n", "bursts", "1");
  EXPECT_TRUE(parse_mount("rot_deg=[0]\n"));
  EXPECT_TRUE(parse_mount("", "views")) << "no mount, no stops needed";
}

/// A plane on a mount with everything that can be wrong with it.
SceneConfig bench(std::uint64_t seed) {
  SceneConfig s;
  s.object = ObjectKind::kPlane;
  s.plane.grid_mm = 2.0;
  s.seed = seed;
  s.path = PathKind::kMount;
  s.timing.burst_rate_hz = 20;
  s.mount.draw = true;
  s.mount.bursts = 2;
  s.mount.move_s = 0.33;
  s.mount.place_mm = {3, -2, 1};
  s.mount.place_turn_deg = 40;
  for (AxisConfig* a : {&s.mount.rotation, &s.mount.swing}) {
    a->stop_error_deg = 0.03;
    a->approach = Approach::kNearest;
    a->has_encoder = true;
    a->encoder_noise_deg = 0;
  }
  for (const double swing : {-15.0, 10.0})
    for (const double rot : {0.0, 100.0, 60.0}) s.mount.stops.push_back({rot, swing});
  return s;
}

TEST(MountPath, the_object_rests_in_a_burst_and_moves_while_the_probe_is_paused) {
  const auto source = source_of(bench(4), small_rig());
  EXPECT_EQ(source->count(), 12U);
  for (std::uint64_t n = 0; n < 12; ++n) {
    const BurstPoses at = source->poses(n);
    EXPECT_TRUE(at.is_static) << n;
    if (n == 0) continue;
    const bool same_stop = n % 2 == 1;
    const double moved = (at.mid.matrix() - source->poses(n - 1).mid.matrix()).norm();
    EXPECT_EQ(moved == 0, same_stop) << n;
    // 0.33 s are seven slots of 50 ms.
    EXPECT_NEAR(1e-9 * static_cast<double>(source->t_mid_ns(n) - source->t_mid_ns(n - 1)), same_stop ? 0.05 : 0.4,
                1e-6);
  }
}

struct AxesRow {
  double key, rot_cmd, swing_cmd, rot_read, swing_read;
};

std::vector<AxesRow> rows_of(const std::string& csv) {
  std::istringstream lines(csv);
  std::string line, header;
  std::getline(lines, header);
  std::vector<AxesRow> out;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    std::array<double, 5> v{};
    for (double& each : v) {
      std::string cell;
      std::getline(cells, cell, ',');
      each = std::stod(cell);
    }
    out.push_back({v[0], v[1], v[2], v[3], v[4]});
  }
  return out;
}

Vector3d vector_of(const nlohmann::json& j) { return {double(j[0]), double(j[1]), double(j[2])}; }

/// Rodrigues, point by point.
Vector3d turned(const nlohmann::json& axis, double deg, const Vector3d& p) {
  const double hc = axis["harmonic_deg"][0], hs = axis["harmonic_deg"][1], a = deg * kPi / 180;
  const double t = (deg + hc * (std::cos(a) - 1) + hs * std::sin(a)) * kPi / 180;
  const Vector3d d = vector_of(axis["direction"]), c = vector_of(axis["point_mm"]), q = p - c;
  return c + q * std::cos(t) + d.cross(q) * std::sin(t) + d * d.dot(q) * (1 - std::cos(t));
}

Vector3d moved(const nlohmann::json& rows, const Vector3d& p) {
  Vector3d out;
  for (std::size_t r = 0; r < 3; ++r) {
    out[static_cast<Eigen::Index>(r)] =
        double(rows[r][0]) * p.x() + double(rows[r][1]) * p.y() + double(rows[r][2]) * p.z() + double(rows[r][3]);
  }
  return out;
}

/// Largest miss in mm of points told from angles and mount_true.json alone, over all bursts.
double miss_mm(std::uint64_t seed, bool use_reading) {
  const SceneConfig scene = bench(seed);
  const auto source = source_of(scene, small_rig());
  const MountRun run = drive(scene.mount, scene.seed);
  const auto truth = nlohmann::json::parse(mount_true_json(run, scene.mount.bursts, "T-1"));
  const AxesTable table{.key = "burst_id", .rows = *source->count(), .rows_a_stop = scene.mount.bursts};
  double most = 0;
  for (const AxesRow& row : rows_of(axes_csv(run, scene.mount, scene.seed, table))) {
    const auto n = static_cast<std::uint64_t>(row.key);
    const Vector3d run_out = 1e-3 * vector_of(truth["stops"][n / 2]["run_out_um"]);
    for (const Vector3d& p : {Vector3d(0, 0, 0), Vector3d(20, -5, 3), Vector3d(-9, 30, -2)}) {
      const Vector3d on_table = moved(truth["T_camera_table"], moved(truth["T_table_model"], p));
      const Vector3d after_rot = turned(truth["rotation"], use_reading ? row.rot_read : row.rot_cmd, on_table);
      const Vector3d told = turned(truth["swing"], use_reading ? row.swing_read : row.swing_cmd, after_rot + run_out);
      most = std::max(most, (told - source->poses(n).mid.inverse() * p).norm());
    }
  }
  return most;
}

TEST(MountFiles, read_angles_and_axes_tell_the_pose_that_is_rendered) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    EXPECT_LT(miss_mm(seed, true), 2e-6);  // six digits of a degree
    EXPECT_GT(miss_mm(seed, false), 5e-3) << "commanded angles miss by stop error and backlash";
  }
}

TEST(MountFiles, the_point_of_an_axis_is_the_nearest_to_the_camera) {
  const SceneConfig scene = bench(9);
  const auto truth = nlohmann::json::parse(mount_true_json(drive(scene.mount, 9), 2, "T-1"));
  for (const char* axis : {"rotation", "swing"}) {
    const Vector3d d = vector_of(truth[axis]["direction"]);
    EXPECT_NEAR(d.norm(), 1, 1e-12);
    EXPECT_NEAR(d.dot(vector_of(truth[axis]["point_mm"])), 0, 1e-9);
  }
}

TEST(MountFiles, a_reading_has_its_noise_and_an_axis_without_encoder_none) {
  MountConfig c;
  c.rotation.has_encoder = true;
  c.rotation.encoder_noise_deg = 0.004;
  c.stops = {{30, 5}};
  constexpr int kRows = 4000;
  const AxesTable table{.key = "pose", .rows = kRows, .rows_a_stop = kRows};
  const std::string csv = axes_csv(drive(c, 1), c, 1, table);
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "pose,rot_cmd_deg,swing_cmd_deg,rot_read_deg,swing_read_deg");
  double squares = 0;
  for (const AxesRow& row : rows_of(csv)) {
    EXPECT_EQ(row.rot_cmd, 30);
    EXPECT_EQ(row.swing_cmd, 5);
    EXPECT_TRUE(std::isnan(row.swing_read));
    squares += std::pow(row.rot_read - 30, 2);
  }
  EXPECT_NEAR(std::sqrt(squares / kRows), 0.004, 5 * 0.004 / std::sqrt(2.0 * kRows));
}

TEST(MountBoard, is_shown_at_the_stops_of_the_mount) {
  SceneConfig scene = bench(2);
  scene.object = ObjectKind::kBoard;
  scene.rig_path = std::string(ENAMEL_SOURCE_DIR) + "/config/rigs/probe.json";
  scene.calibration.cycles = {1};
  const auto stage = BoardStage::create(scene);
  ASSERT_TRUE(stage) << stage.error().message();
  const std::vector<Pose> want = mount_poses(drive(scene.mount, scene.seed));
  ASSERT_EQ((*stage)->stands().size(), want.size());
  for (std::size_t i = 0; i < want.size(); ++i) EXPECT_EQ((*stage)->stands()[i].matrix(), want[i].matrix());
}

}  // namespace
}  // namespace enamel::twin::testing
