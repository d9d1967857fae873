// The twin's desktop mount from the command line: a board of coded dots at the stops, and recordings with their angles.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <vector>

#include "tests/support/run.hpp"

namespace enamel::test {
namespace {

using Json = nlohmann::json;
using Point = std::array<double, 3>;

std::string scene(const std::string& name) { return std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/" + name; }

Ran twin(const std::string& command, const std::string& name, const std::string& out,
         const std::vector<std::string>& overrides) {
  std::vector<std::string> argv{program("enamel-twin"), command, scene(name), "--out", out};
  for (const std::string& o : overrides) argv.insert(argv.end(), {"--set", o});
  return run(argv, std::chrono::seconds(300));
}

std::vector<std::string> lines_of(const std::string& path) {
  std::istringstream text(read_file(path).value_or(""));
  std::vector<std::string> out;
  for (std::string line; std::getline(text, line);) out.push_back(line);
  return out;
}

/// A row of poses.csv without its first two columns: translation and quaternion of T_model_cam.
std::array<double, 7> pose_of(const std::string& row) {
  std::istringstream cells(row);
  std::string cell;
  std::array<double, 7> out{};
  for (int i = 0; std::getline(cells, cell, ','); ++i) {
    if (i >= 2) out[static_cast<std::size_t>(i - 2)] = std::stod(cell);
  }
  return out;
}

/// A point of the board in the camera's frame: rotated back by the conjugate quaternion.
Point in_camera(const std::array<double, 7>& pose, const Point& p) {
  const double x = -pose[3], y = -pose[4], z = -pose[5], w = pose[6];
  const Point q{p[0] - pose[0], p[1] - pose[1], p[2] - pose[2]};
  const Point t{2 * (y * q[2] - z * q[1]), 2 * (z * q[0] - x * q[2]), 2 * (x * q[1] - y * q[0])};
  return {q[0] + w * t[0] + y * t[2] - z * t[1], q[1] + w * t[1] + z * t[0] - x * t[2],
          q[2] + w * t[2] + x * t[1] - y * t[0]};
}

/// Nearest pixel.
std::array<long, 2> pixel_of(const Json& camera, const Point& p) {
  const double x = p[0] / p[2], y = p[1] / p[2], r2 = x * x + y * y;
  const auto k = [&](std::size_t i) { return camera["dist"][i].get<double>(); };
  const auto of = [&](const char* key) { return camera[key].get<double>(); };
  const double g = 1 + k(0) * r2 + k(1) * r2 * r2 + k(4) * r2 * r2 * r2;
  return {std::lround(of("fx") * (x * g + 2 * k(2) * x * y + k(3) * (r2 + 2 * x * x)) + of("cx")),
          std::lround(of("fy") * (y * g + k(2) * (r2 + 2 * y * y) + 2 * k(3) * x * y) + of("cy"))};
}

struct Seen {
  int right = 0, wrong = 0;
};

/// Dots whose middle is as bright as the board's map says: full ones bright, rings dark.
Seen dots_as_mapped(const cv::Mat& white, const Json& target, const Json& rig, const std::array<double, 7>& pose) {
  constexpr int kBorder_px = 12;
  const int cols = target["cols"], rows = target["rows"];
  const double pitch = target["pitch_mm"];
  const double threshold = 0.5 * cv::mean(white)[0] + 30;  // between ground, some 25, and dots, some 130
  Seen out;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      const Point p = in_camera(pose, {(c - 0.5 * (cols - 1)) * pitch, (r - 0.5 * (rows - 1)) * pitch, 0});
      const auto [u, v] = pixel_of(rig["camera"], p);
      if (u < kBorder_px || v < kBorder_px || u >= white.cols - kBorder_px || v >= white.rows - kBorder_px) continue;
      const bool is_ring =
          target["rings"][static_cast<std::size_t>(r)].get<std::string>()[static_cast<std::size_t>(c)] == '1';
      const bool is_dark = white.at<std::uint8_t>(static_cast<int>(v), static_cast<int>(u)) < threshold;
      ++(is_ring == is_dark ? out.right : out.wrong);
    }
  }
  return out;
}

TEST(DesktopBoard, is_rendered_at_every_stop_where_the_truth_says_it_was) {
  const TempFolder tmp;
  const Ran ran =
      twin("calibrate", "desktop_board.toml", tmp / "set",
           {"calibration.fringes=false", "mount.rot_deg=[0,290]", "mount.swing_deg=[-20,10]", "mount.stop=[]"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto target = Json::parse(read_file(tmp / "set/target.json").value_or(""), nullptr, false);
  const auto rig = Json::parse(read_file(tmp / "set/truth/rig.json").value_or(""), nullptr, false);
  const auto truth = Json::parse(read_file(tmp / "set/truth/mount_true.json").value_or(""), nullptr, false);
  ASSERT_TRUE(target.is_object() && rig.is_object() && truth.is_object());
  EXPECT_EQ(target["type"], "coded_dots");
  EXPECT_EQ(truth["stops"].size(), 4U);
  const auto axes = lines_of(tmp / "set/axes.csv"), poses = lines_of(tmp / "set/truth/poses.csv");
  ASSERT_EQ(axes.size(), 5U);
  ASSERT_EQ(poses.size(), 5U);
  EXPECT_EQ(axes[0], "pose,rot_cmd_deg,swing_cmd_deg,rot_read_deg,swing_read_deg");
  EXPECT_EQ(axes[4].substr(0, 24), "3,290.000000,10.000000,2");
  for (std::size_t n = 0; n < 4; ++n) {
    const std::string folder = tmp / ("set/poses/0" + std::to_string(n));
    const cv::Mat white = cv::imread(folder + "/white.png", cv::IMREAD_UNCHANGED);
    ASSERT_FALSE(white.empty());
    EXPECT_TRUE(std::filesystem::exists(folder + "/black.png"));
    EXPECT_FALSE(std::filesystem::exists(folder + "/v_64_0.png")) << "fringes are switched off";
    const Seen seen = dots_as_mapped(white, target, rig, pose_of(poses[n + 1]));
    EXPECT_GT(seen.right, 50) << n;
    EXPECT_EQ(seen.wrong, 0) << n;
    // Negative control: the pose of another stop.
    EXPECT_GT(dots_as_mapped(white, target, rig, pose_of(poses[(n + 1) % 4 + 1])).wrong, 10) << n;
  }
}

TEST(DesktopScan, a_recording_carries_its_angles_and_a_seed_its_own_mount) {
  const TempFolder tmp;
  const std::vector<std::string> form{"mount.rot_deg=[0,15]", "mount.swing_deg=[0]", "mount.bursts=2",
                                      "object.plate.bumps=0"};
  ASSERT_EQ(twin("render", "desktop_bar.toml", tmp / "a.mcap", form).code, 0);
  ASSERT_EQ(run({program("enamel"), "capture", "export", tmp / "a.mcap", tmp / "a"}).code, 0);
  const Ran info = run({program("enamel"), "capture", "info", tmp / "a.mcap", "--json"});
  EXPECT_EQ(Json::parse(info.out, nullptr, false)["axes"], 4);
  const auto axes = lines_of(tmp / "a/axes.csv");
  ASSERT_EQ(axes.size(), 5U);
  EXPECT_EQ(axes[0], "burst_id,rot_cmd_deg,swing_cmd_deg,rot_read_deg,swing_read_deg");
  EXPECT_EQ(axes[3].substr(0, 21), "2,15.000000,0.000000,");
  EXPECT_NEAR(std::stod(axes[3].substr(21)), 15, 0.1);
  EXPECT_EQ(axes[4].substr(axes[4].size() - 4), ",nan");
  auto other = form;
  other.emplace_back("seed=2");
  ASSERT_EQ(twin("render", "desktop_bar.toml", tmp / "b", other).code, 0);
  const auto mount = [&](const std::string& folder) {
    return Json::parse(read_file(tmp / (folder + "/truth/mount_true.json")).value_or(""), nullptr, false);
  };
  EXPECT_NE(mount("a")["rotation"]["direction"], mount("b")["rotation"]["direction"]);
}

TEST(DesktopScan, a_bad_mount_writes_nothing_and_names_the_key) {
  const TempFolder tmp;
  const Ran ran = twin("render", "desktop_bar.toml", tmp / "out", {"mount.rot_deg={from=0,to=90,step=-5}"});
  EXPECT_NE(ran.code, 0);
  EXPECT_NE(ran.err.find("mount.rot_deg.step"), std::string::npos) << ran.err;
  EXPECT_FALSE(std::filesystem::exists(tmp / "out"));
  const Ran many = twin("calibrate", "desktop_board.toml", tmp / "out", {"mount.rot_deg={from=0,to=359,step=1}"});
  EXPECT_NE(many.code, 0);
  EXPECT_NE(many.err.find("at most 99 poses"), std::string::npos) << many.err;
  EXPECT_FALSE(std::filesystem::exists(tmp / "out"));
}

}  // namespace
}  // namespace enamel::test
