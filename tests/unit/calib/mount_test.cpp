// The mount's model and file, the table of its angles, and boards whose dots say which they are.
#include "calib/model/mount.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <numbers>

#include "calib/mount/stops.hpp"
#include "calib/target/code_map.hpp"
#include "calib/target/coded_grid.hpp"
#include "protocol/base/rng.hpp"
#include "protocol/types/axes_table.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/temp_folder.hpp"

namespace enamel::calib {
namespace {

using testing::HasSubstr;

Mount drawn_mount(std::uint64_t seed) {
  Rng rng(seed, 0, 11);
  Mount m;
  m.serial = "D-7";
  for (AxisLine* line : {&m.rotation, &m.swing}) {
    const Eigen::Vector3d d = Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized();
    line->direction = {d.x(), d.y(), d.z()};
    line->point_mm = {rng.uniform(-30, 30), rng.uniform(-30, 30), rng.uniform(0, 60)};
    line->harmonic_rad = {rng.uniform(-1e-3, 1e-3), rng.uniform(-1e-3, 1e-3)};
  }
  return m;
}

TEST(Mount, moves_the_table_as_two_turns_about_lines) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Mount m = drawn_mount(seed);
    const AxisAngles angles{1.1, -0.3};
    const Matrix4 got = table_motion(m, angles, {.pose = {}, .rotation_rad = 1e-3, .swing_rad = -2e-3});
    const auto about = [](const AxisLine& l, double a) {
      const Eigen::Vector3d p(l.point_mm.data()), d(l.direction.data());
      return Eigen::Translation3d(p) * Eigen::AngleAxisd(a, d) * Eigen::Translation3d(-p);
    };
    const auto angle = [](const AxisLine& l, double a, double own) {
      return a + own + l.harmonic_rad[0] * (std::cos(a) - 1) + l.harmonic_rad[1] * std::sin(a);
    };
    const Eigen::Isometry3d want(about(m.swing, angle(m.swing, -0.3, -2e-3)) *
                                 about(m.rotation, angle(m.rotation, 1.1, 1e-3)));
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c)
        EXPECT_NEAR(got[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)], want.matrix()(r, c), 1e-12);
  }
}

TEST(Mount, takes_what_was_read_before_what_was_commanded) {
  const AxisAngles read{1, 2, 1.5, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_EQ(read.rotation(), 1.5);
  EXPECT_EQ(read.swing(), 2);
}

TEST(MountFile, comes_back_as_it_was_written) {
  Mount m = drawn_mount(3);
  m.stop_corrections.push_back({"04", 1e-4, -1e-4});
  const auto text = mount_text(m);
  ASSERT_TRUE(text) << text.error().message();
  const auto back = parse_mount(*text);
  ASSERT_TRUE(back) << back.error().message();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(back->swing.direction[i], m.swing.direction[i], 1e-15);
    EXPECT_EQ(back->rotation.point_mm[i], m.rotation.point_mm[i]);
  }
  EXPECT_NEAR(back->rotation.harmonic_rad[1], m.rotation.harmonic_rad[1], 1e-15);
  ASSERT_EQ(back->stop_corrections.size(), 1U);
  EXPECT_EQ(back->stop_corrections[0].pose, "04");
}

TEST(MountFile, of_the_twin_tells_its_serial_where_it_has_one) {
  const std::string line = R"({"direction": [0, 0, 1], "point_mm": [1, 2, 0], "harmonic_deg": [0, 0]})";
  const auto truth = [&](const std::string& more) {
    return parse_mount(R"({"format": "enamel-mount-truth", "schema": 1, "rotation": )" + line + R"(, "swing": )" +
                       line + more + "}");
  };
  EXPECT_EQ(truth(R"(, "serial": "D-7")").value().serial, "D-7");
  EXPECT_EQ(truth("").value().serial, "");
  EXPECT_THAT(truth(R"(, "serial": 7)").error().detail, HasSubstr("serial"));
}

TEST(MountFile, refuses_what_was_changed_or_is_no_mount) {
  std::string text = mount_text(drawn_mount(4)).value();
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    return parse_mount(changed);
  };
  EXPECT_THAT(with("D-7", "D-8").error().detail, HasSubstr("sha256"));
  EXPECT_THAT(with("\"schema\": 1", "\"schema\": 2").error().detail, HasSubstr("schema"));
  EXPECT_THAT(with("\"positive\"", "\"upward\"").error().detail, HasSubstr("approach"));
  EXPECT_THAT(with("\"direction\": [", "\"direction\": [5,").error().detail, HasSubstr("rotation.direction"));
  for (const char* foreign : {"{}", "[1", ""}) EXPECT_EQ(parse_mount(foreign).error().code, ErrorCode::kMountInvalid);
  EXPECT_EQ(with("D-7", "D-8").error().code, ErrorCode::kMountInvalid);
  EXPECT_TRUE(parse_mount(text)) << "negative control";
}

TEST(AxesTable, of_poses_lacks_neither_file_nor_row) {
  const test::TempFolder folder;
  const std::vector<std::string> poses{"00", "01"};
  const std::string head = "pose,rot_cmd_deg,swing_cmd_deg,rot_read_deg,swing_read_deg\n";
  const auto read = [&](const std::string& rows) {
    test::spill(folder / "axes.csv", head + rows);
    return read_pose_axes(folder / ".", poses);
  };
  EXPECT_EQ(read_pose_axes(folder / ".", poses).error().code, ErrorCode::kAxesMissing);
  EXPECT_EQ(read("0,10,5,,\n").error().code, ErrorCode::kAxesMissing);
  EXPECT_THAT(read("0,10,5,,\n").error().detail, HasSubstr("no row for pose '01'"));
  EXPECT_EQ(read("0,10,5,,\n1,1,1,,\n2,1,1,,\n").error().code, ErrorCode::kCalibrationFolder);
  EXPECT_TRUE(read("1,10,5,,\n00,1,1,,\n")) << "negative control";
}

TEST(AxesTable, reads_rows_and_names_what_is_wrong) {
  const std::string head = "burst_id,rot_cmd_deg,swing_cmd_deg,rot_read_deg,swing_read_deg\n";
  const auto read = [&](const std::string& rows) { return proto::parse_burst_axes(head + rows, "axes.csv"); };
  const auto good = read("7,10,-20,10.5,nan\n9,20,,21,3\n");
  ASSERT_TRUE(good) << good.error().message();
  EXPECT_EQ((*good)[0].burst_index, 7U);
  EXPECT_TRUE(std::isnan((*good)[0].swing_read_deg));
  EXPECT_TRUE(std::isnan((*good)[1].swing_cmd_deg));
  EXPECT_EQ(proto::parse_burst_axes(proto::axes_table_text(*good), "again").value(), *good);
  EXPECT_THAT(read("7,1,2,3\n").error().detail, HasSubstr("axes.csv:2: 4 fields"));
  EXPECT_THAT(read("7,400,2,,\n").error().detail, HasSubstr("rot_cmd_deg"));
  EXPECT_THAT(read("7,1,2,,\n7,1,2,,\n").error().detail, HasSubstr("axes.csv:3: burst_id 7 stands twice"));
  EXPECT_THAT(read("x,1,2,,\n").error().detail, HasSubstr("burst_id"));
  EXPECT_THAT(read("7,,2,,\n").error().detail, HasSubstr("neither"));
  EXPECT_FALSE(read(""));
  EXPECT_FALSE(proto::parse_burst_axes("pose,a\n", "axes.csv"));
}

TargetDesign board(std::uint64_t seed) {
  const auto map = make_code_map(40, 40, seed);
  return parse_target(coded_target_text(map.value(), 1.6, 0.4, 0.2).value()).value();
}

TEST(CodeMap, has_windows_that_occur_once) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    auto map = make_code_map(40, 40, seed);
    ASSERT_TRUE(map) << map.error().message();
    EXPECT_TRUE(check_code_map(*map));
    EXPECT_EQ(map->bits, make_code_map(40, 40, seed)->bits);
    // A window copied to another place is found out.
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x) map->bits[static_cast<std::size_t>((20 + y) * 40 + 20 + x)] = map->at(3 + x, 5 + y);
    EXPECT_THAT(check_code_map(*map).error().detail, HasSubstr("alike"));
  }
  EXPECT_FALSE(make_code_map(150, 150, 1));
  EXPECT_FALSE(make_code_map(3, 9, 1));
}

/// A window of cols x rows dots from (col, row), seen after `turns` quarter turns; every `wrong`-th bit is misread.
std::vector<CodedDot> seen(const TargetDesign& t, GridIndex from, int side, int turns, int wrong) {
  std::vector<CodedDot> dots;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      int a = x, b = y;
      for (int k = 0; k < turns; ++k) {
        const int turned = -b;
        b = a;
        a = turned;
      }
      int bit = t.rings[static_cast<std::size_t>(t.index({from.col + x, from.row + y}))];
      if (wrong > 0 && (y * side + x) % wrong == 0) bit = 1 - bit;
      dots.push_back({a, b, bit});
    }
  }
  return dots;
}

TEST(CodedBoard, is_placed_by_what_is_seen_of_it) {
  const TargetDesign t = board(1);
  Rng rng(5, 0, 12);
  for (int draw = 0; draw < 8; ++draw) {
    const GridIndex from{static_cast<int>(rng.below(30)), static_cast<int>(rng.below(30))};
    const auto dots = seen(t, from, 8, draw % 4, draw % 2 == 0 ? 0 : 30);
    const auto placed = place_on_map(dots, t);
    ASSERT_TRUE(placed) << placed.error().message();
    EXPECT_EQ(t.index(placed->at(dots[0])), t.index(from));
    EXPECT_EQ(t.index(placed->at(dots[63])), t.index({from.col + 7, from.row + 7}));
  }
}

TEST(CodedBoard, is_not_guessed) {
  const TargetDesign t = board(1);
  EXPECT_THAT(place_on_map(seen(t, {9, 9}, 4, 0, 0), t).error().detail, HasSubstr("too few"));
  EXPECT_THAT(place_on_map(seen(board(2), {9, 9}, 9, 1, 0), t).error().detail, HasSubstr("another board"));
  auto mirrored = seen(t, {9, 9}, 8, 0, 0);
  for (CodedDot& d : mirrored) d.a = -d.a;
  EXPECT_EQ(place_on_map(mirrored, t).error().code, ErrorCode::kTargetMirrored);
}

}  // namespace
}  // namespace enamel::calib
