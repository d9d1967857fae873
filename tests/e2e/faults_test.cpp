// Bad input and faults as a person meets them: the real program, one clear message with cause and remedy, the right
// exit code, nothing half-written.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "tests/support/run.hpp"

namespace enamel::test {
namespace {

namespace fs = std::filesystem;

std::string small_capture() { return std::string(ENAMEL_BIN_DIR) + "/../fixtures/small.mcap"; }

void expect_told(const Ran& ran, int code, const std::string& part) {
  EXPECT_EQ(ran.code, code) << ran.err;
  EXPECT_NE(ran.err.find(part), std::string::npos) << "wanted '" << part << "' in:\n" << ran.err;
  EXPECT_NE(ran.err.find("what to do:"), std::string::npos) << ran.err;
}

Ran replay(const std::string& input, const std::string& out, std::vector<std::string> more = {}) {
  std::vector<std::string> argv{program("enamel"), "replay", input, "--out", out, "--headless"};
  argv.insert(argv.end(), more.begin(), more.end());
  return run(argv);
}

/// Three bursts of the small capture as an exchange folder, to be damaged.
std::string small_folder(const TempFolder& tmp) {
  const std::string cut = tmp / "cut.mcap";
  std::string folder = tmp / "folder";
  EXPECT_EQ(run({program("enamel"), "capture", "cut", small_capture(), cut, "--last", "2"}).code, 0);
  EXPECT_EQ(run({program("enamel"), "capture", "export", cut, folder}).code, 0);
  return folder;
}

void replace_in(const std::string& path, const std::string& from, const std::string& to) {
  std::string text = read_file(path).value_or("");
  const auto at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  ASSERT_TRUE(write_file(path, text));
}

TEST(Faults, MissingRecording) {
  const TempFolder tmp;
  expect_told(replay("/nowhere/x.mcap", tmp / "out"), 2, "file not found: /nowhere/x.mcap");
}

TEST(Faults, EmptyAndForeignFile) {
  const TempFolder tmp;
  ASSERT_TRUE(write_file(tmp / "empty.mcap", ""));
  expect_told(replay(tmp / "empty.mcap", tmp / "out"), 2, "recording not usable");
  ASSERT_TRUE(write_file(tmp / "foreign.mcap", std::string(5000, 'x')));
  expect_told(replay(tmp / "foreign.mcap", tmp / "out"), 2, "recording not usable");
}

TEST(Faults, EmptyFolder) {
  const TempFolder tmp;
  fs::create_directory(tmp / "folder");
  expect_told(replay(tmp / "folder", tmp / "out"), 2, "exchange folder not usable");
}

TEST(Faults, TruncatedRecordingIsReplayedAsFarAsItGoes) {
  const TempFolder tmp;
  const std::string whole = read_file(small_capture()).value_or("");
  ASSERT_GT(whole.size(), 1000U);
  ASSERT_TRUE(write_file(tmp / "cut.mcap", whole.substr(0, whole.size() / 2)));
  const Ran ran =
      replay(tmp / "cut.mcap", tmp / "out", {"--rig", std::string(ENAMEL_SOURCE_DIR) + "/config/rigs/probe.json"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_NE(ran.err.find("truncated"), std::string::npos) << ran.err;
  EXPECT_TRUE(fs::exists(tmp / "out/mesh.ply"));
}

TEST(Faults, FlippedBitIsCaughtCountedAndPassedOver) {
  const TempFolder tmp;
  std::string bytes = read_file(small_capture()).value_or("");
  ASSERT_GT(bytes.size(), 1000U);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
  ASSERT_TRUE(write_file(tmp / "flipped.mcap", bytes));
  const Ran ran = replay(tmp / "flipped.mcap", tmp / "out");
  EXPECT_EQ(ran.code, 4) << ran.err;
  EXPECT_NE(ran.err.find("recording is damaged"), std::string::npos) << ran.err;
  EXPECT_TRUE(fs::exists(tmp / "out/mesh.ply"));
}

TEST(Faults, FolderWithoutCalibration) {
  const TempFolder tmp;
  const std::string folder = small_folder(tmp);
  fs::remove(folder + "/rig.json");
  expect_told(replay(folder, tmp / "out"), 2, "rig.json");
}

TEST(Faults, NanInCalibration) {
  const TempFolder tmp;
  const std::string folder = small_folder(tmp);
  replace_in(folder + "/rig.json", "\"fx\":", "\"fx\": NaN, \"was\":");
  expect_told(replay(folder, tmp / "out"), 2, "calibration not usable");
}

TEST(Faults, PatternSetOfACalibrationTarget) {
  const TempFolder tmp;
  const std::string folder = small_folder(tmp);
  replace_in(folder + "/rig.json", "\"T\"", "\"multi\"");
  expect_told(replay(folder, tmp / "out"), 2, "pattern set does not fit");
}

TEST(Faults, FrameOfAnotherSize) {
  const TempFolder tmp;
  const std::string folder = small_folder(tmp);
  ASSERT_TRUE(cv::imwrite(folder + "/frames/000001_2.png", cv::Mat::zeros(100, 100, CV_8U)));
  const Ran ran = run({program("enamel"), "capture", "import", folder, tmp / "out.mcap"});
  expect_told(ran, 2, "000001_2.png");
  EXPECT_FALSE(fs::exists(tmp / "out.mcap"));
}

TEST(Faults, FrameOfAnotherDepth) {
  const TempFolder tmp;
  const std::string folder = small_folder(tmp);
  ASSERT_TRUE(cv::imwrite(folder + "/frames/000001_2.png", cv::Mat::zeros(480, 640, CV_16U)));
  expect_told(run({program("enamel"), "capture", "import", folder, tmp / "out.mcap"}), 2, "000001_2.png");
}

TEST(Faults, UnknownConfigurationKeyNamesLineAndNearestKey) {
  const TempFolder tmp;
  ASSERT_TRUE(write_file(tmp / "c.toml", "[fuse]\nvoxel_mn = 0.1\n"));
  const Ran ran = replay(small_capture(), tmp / "out", {"--config", tmp / "c.toml"});
  expect_told(ran, 2, "c.toml:2");
  EXPECT_NE(ran.err.find("voxel_mm"), std::string::npos) << ran.err;
}

TEST(Faults, ConfigurationValueOutOfRange) {
  const TempFolder tmp;
  expect_told(replay(small_capture(), tmp / "out", {"--set", "fuse.voxel_mm=-1"}), 2, "voxel_mm");
}

TEST(Faults, OutputThatCannotBeWritten) {
  expect_told(replay(small_capture(), "/proc/nowhere"), 2, "file cannot be written");
}

TEST(Faults, FullDisk) {
  const TempFolder tmp;
  // Files may grow to 200 KiB: the mesh does not fit.
  const Ran ran = run({"/bin/bash", "-c",
                       "ulimit -f 200; exec " + program("enamel") + " replay " + small_capture() +
                           " --headless --out " + (tmp / "out")});
  expect_told(ran, 2, "file cannot be written");
  EXPECT_FALSE(fs::exists(tmp / "out/mesh.ply")) << "half-written mesh left behind";
  EXPECT_FALSE(fs::exists(tmp / "out/mesh.ply.partial"));
}

TEST(Faults, ViewWithoutDisplay) {
  const TempFolder tmp;
  const Ran ran = run({"/usr/bin/env", "-u", "DISPLAY", "-u", "WAYLAND_DISPLAY", program("enamel"), "replay",
                       small_capture(), "--out", tmp / "out", "--view"});
  expect_told(ran, 3, "no display");
}

TEST(Faults, BurstThatIsNotThere) {
  const TempFolder tmp;
  expect_told(run({program("enamel"), "decode", small_capture(), "--burst", "99999", "--out", tmp / "out"}), 2,
              "no such burst");
}

TEST(Faults, NoProbe) {
  const TempFolder tmp;
  expect_told(run({program("enamel"), "scan", "--headless", "--session", tmp / "s", "--dds-tag", unique_tag(),
                   "--wait-seconds", "1"}),
              3, "no probe found");
}

TEST(Faults, WrongUsage) {
  EXPECT_EQ(run({program("enamel"), "replay"}).code, 1);
  EXPECT_EQ(run({program("enamel"), "nonsense"}).code, 1);
  EXPECT_EQ(run({program("enamel"), "--help"}).code, 0);
}

}  // namespace
}  // namespace enamel::test
