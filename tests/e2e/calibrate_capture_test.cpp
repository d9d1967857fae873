// Pictures of a calibration taken live: enamel-probe plays a rendered board, enamel guides, over Cyclone DDS on
// loopback.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/run.hpp"

namespace enamel::test {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;

const std::string kScene = std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/calibration.toml";
const std::string kTarget = std::string(ENAMEL_SOURCE_DIR) + "/config/targets/dots_9x7.json";

/// A board at `poses` stands, each pattern set shown once, as a recording.
std::string render(const TempFolder& tmp, int poses, const std::vector<std::string>& settings = {}) {
  const std::string capture = tmp / "board.mcap";
  std::vector<std::string> argv{program("enamel-twin"), "calibrate", kScene, "--poses", std::to_string(poses), "--set",
                                "calibration.sweeps=1", "--out",     capture};
  for (const auto& setting : settings) argv.insert(argv.end(), {"--set", setting});
  const Ran ran = run(argv, seconds(240));
  EXPECT_EQ(ran.code, 0) << ran.err;
  return capture;
}

struct Taken {
  Ran ran;
  nlohmann::json json;
};

Taken take(const TempFolder& tmp, const std::string& capture, int poses) {
  const std::string tag = unique_tag();
  const auto probe =
      app::ChildProcess::start({program("enamel-probe"), "--play", capture, "--serial", "CAL", "--dds-tag", tag},
                               {tmp / "p.out", tmp / "p.log"});
  EXPECT_TRUE(probe);
  Taken taken{run({program("enamel"), "calibrate", "capture", "--target", kTarget, "--out", tmp / "set", "--dds-tag",
                   tag, "--poses", std::to_string(poses), "--sweeps", "1", "--json"},
                  seconds(240)),
              {}};
  taken.json = nlohmann::json::parse(taken.ran.out, nullptr, false);
  return taken;
}

void expect_nothing_written(const TempFolder& tmp) {
  EXPECT_FALSE(fs::exists(tmp / "set"));
  EXPECT_FALSE(fs::exists(tmp / "set.partial"));
}

/// Six stands, rendered once.
const std::string& six_stands() {
  static const TempFolder tmp;
  static const std::string capture = render(tmp, 6);
  return capture;
}

TEST(CalibrateCapture, poses_of_a_live_probe_make_a_folder_that_solves) {
  const TempFolder tmp;
  const Taken taken = take(tmp, six_stands(), 5);
  ASSERT_EQ(taken.ran.code, 0) << taken.ran.err;
  EXPECT_TRUE(taken.json["simulated"].get<bool>());
  EXPECT_GE(taken.json["poses_accepted"].get<int>(), 5) << taken.json;
  for (const auto& pose : taken.json["poses"]) {
    EXPECT_GT(pose["depth_mm"].get<double>(), 40) << pose;
    EXPECT_LT(pose["depth_mm"].get<double>(), 56) << pose;
    EXPECT_EQ(pose["dots"], 63) << pose;
  }
  EXPECT_TRUE(fs::exists(tmp / "set/coverage.png"));
  EXPECT_TRUE(fs::exists(tmp / "set/poses/04/h_64_3.png"));
  const Ran solve = run({program("enamel"), "calibrate", "solve", tmp / "set", "--out", tmp / "rig.json", "--json"});
  const auto solved = nlohmann::json::parse(solve.out, nullptr, false);
  ASSERT_TRUE(solved.is_object()) << solve.err;
  EXPECT_EQ(solved["poses_used"], taken.json["poses_accepted"]) << solve.out;
  // Single frames have four times the noise of averages over sixteen.
  EXPECT_LT(solved["expected"]["p95_um"].get<double>(), 2.0) << solve.out;
}

TEST(CalibrateCapture, too_few_poses_leave_nothing) {
  const TempFolder tmp;
  const Taken taken = take(tmp, six_stands(), 10);
  EXPECT_EQ(taken.ran.code, 2);
  EXPECT_NE(taken.ran.err.find("of 10 poses taken"), std::string::npos) << taken.ran.err;
  EXPECT_EQ(taken.json["verdict"], "refused");
  EXPECT_FALSE(taken.json["missing"].empty());
  expect_nothing_written(tmp);
}

TEST(CalibrateCapture, blurred_board_is_refused_as_blurred) {
  const TempFolder tmp;
  const Taken taken = take(tmp, render(tmp, 1, {"camera.psf_sigma_px=2.5"}), 3);
  EXPECT_EQ(taken.ran.code, 2);
  ASSERT_FALSE(taken.json["poses"].empty()) << taken.ran.err;
  for (const auto& pose : taken.json["poses"]) {
    EXPECT_FALSE(pose["accepted"].get<bool>());
    EXPECT_NE(pose["reasons"].dump().find("blurred"), std::string::npos) << pose;
  }
  expect_nothing_written(tmp);
}

TEST(CalibrateCapture, two_boards_are_refused_as_two) {
  const TempFolder tmp;
  const Taken taken = take(
      tmp, render(tmp, 1, {"board.doubled=true", "board.pitch_mm=0.8", "board.radius_mm=0.2", "board.margin_mm=0.6"}),
      3);
  EXPECT_EQ(taken.ran.code, 2);
  ASSERT_FALSE(taken.json["poses"].empty()) << taken.ran.err;
  int named = 0;
  for (const auto& pose : taken.json["poses"]) {
    EXPECT_FALSE(pose["accepted"].get<bool>());
    named += pose["reasons"].dump().find("more than one") != std::string::npos ? 1 : 0;
  }
  EXPECT_GT(named, 0) << taken.json;
  expect_nothing_written(tmp);
}

TEST(CalibrateCapture, a_probe_that_shows_scanning_patterns_is_refused) {
  const TempFolder tmp;
  const Taken taken = take(tmp, std::string(ENAMEL_BIN_DIR) + "/../fixtures/small.mcap", 5);
  EXPECT_EQ(taken.ran.code, 2);
  EXPECT_NE(taken.ran.err.find("mode multi"), std::string::npos) << taken.ran.err;
  expect_nothing_written(tmp);
}

}  // namespace
}  // namespace enamel::test
