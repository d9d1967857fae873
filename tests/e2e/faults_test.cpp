// Bad input and faults as a person meets them: the real program, one clear message with cause and remedy, the right
// exit code, nothing half-written.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "tests/e2e/small_capture.hpp"
#include "tests/support/run.hpp"

namespace enamel::test {
namespace {

namespace fs = std::filesystem;

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

/// One of config/rigs in place of the folder's own.
void put_rig(const std::string& folder, const std::string& name) {
  fs::copy_file(std::string(ENAMEL_SOURCE_DIR) + "/config/rigs/" + name + ".json", folder + "/rig.json",
                fs::copy_options::overwrite_existing);
}

TEST(Faults, missing_recording) {
  const TempFolder tmp;
  expect_told(replay("/nowhere/x.mcap", tmp / "out"), 2, "file not found: /nowhere/x.mcap");
}

TEST(Faults, empty_and_foreign_file) {
  const TempFolder tmp;
  ASSERT_TRUE(write_file(tmp / "empty.mcap", ""));
  expect_told(replay(tmp / "empty.mcap", tmp / "out"), 2, "recording not usable");
  ASSERT_TRUE(write_file(tmp / "foreign.mcap", std::string(5000, 'x')));
  expect_told(replay(tmp / "foreign.mcap", tmp / "out"), 2, "recording not usable");
}

TEST(Faults, empty_folder) {
  const TempFolder tmp;
  fs::create_directory(tmp / "folder");
  expect_told(replay(tmp / "folder", tmp / "out"), 2, "exchange folder not usable");
}

TEST(Faults, truncated_recording_is_replayed_as_far_as_it_goes) {
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

/// What is left over in a buffer is as old as the camera's ring is long: four frames, or eight.
TEST(Faults, frame_left_over_from_a_burst_before_costs_that_burst) {
  for (const std::size_t bursts_ago : {1U, 2U}) {
    const TempFolder tmp;
    const std::string folder = small_folder(tmp);
    std::vector<std::string> frames;
    for (const auto& entry : fs::directory_iterator(fs::path(folder) / "frames")) frames.push_back(entry.path());
    std::sort(frames.begin(), frames.end());
    ASSERT_GE(frames.size(), 12U);
    const std::string stale = frames[frames.size() - 2], before = frames[frames.size() - 2 - 4 * bursts_ago];
    fs::copy_file(before, stale, fs::copy_options::overwrite_existing);  // frame 2 of the last burst
    const Ran ran = replay(folder, tmp / "out");
    const std::string report = read_file(tmp / "out/report.json").value_or("");
    EXPECT_NE(report.find("\"pattern_set_mismatch\": 1"), std::string::npos) << bursts_ago << ran.err << report;
    const std::string last = std::to_string(std::stoul(fs::path(stale).filename().string()));
    const std::vector<std::string> decode{program("enamel"), "decode", folder, "--burst", last, "--out", tmp / "maps"};
    EXPECT_EQ(run(decode).code, 6) << bursts_ago;
  }
}

TEST(Faults, flipped_bit_is_caught_counted_and_passed_over) {
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

TEST(Faults, folder_without_calibration) {
  const TempFolder tmp;
  const std::string folder = small_folder(tmp);
  fs::remove(folder + "/rig.json");
  expect_told(replay(folder, tmp / "out"), 2, "rig.json");
}

TEST(Faults, nan_in_calibration) {
  const TempFolder tmp;
  const std::string folder = small_folder(tmp);
  replace_in(folder + "/rig.json", "\"fx\":", "\"fx\": NaN, \"was\":");
  expect_told(replay(folder, tmp / "out"), 2, "calibration not usable");
}

TEST(Faults, pattern_set_of_a_calibration_target) {
  const TempFolder tmp;
  const std::string folder = small_folder(tmp);
  put_rig(folder, "probe_t");
  replace_in(folder + "/rig.json", "\"T\"", "\"multi\"");
  expect_told(replay(folder, tmp / "out"), 2, "pattern set does not fit");
}

TEST(Faults, frame_of_another_size) {
  const TempFolder tmp;
  const std::string folder = small_folder(tmp);
  ASSERT_TRUE(cv::imwrite(folder + "/frames/000001_2.png", cv::Mat::zeros(100, 100, CV_8U)));
  const Ran ran = run({program("enamel"), "capture", "import", folder, tmp / "out.mcap"});
  expect_told(ran, 2, "000001_2.png");
  EXPECT_FALSE(fs::exists(tmp / "out.mcap"));
}

TEST(Faults, frame_of_another_depth) {
  const TempFolder tmp;
  const std::string folder = small_folder(tmp);
  ASSERT_TRUE(cv::imwrite(folder + "/frames/000001_2.png", cv::Mat::zeros(480, 640, CV_16U)));
  expect_told(run({program("enamel"), "capture", "import", folder, tmp / "out.mcap"}), 2, "000001_2.png");
}

Ran decode(const std::string& folder, const std::string& out) {
  return run({program("enamel"), "decode", folder, "--burst", "1", "--out", out});
}

TEST(Faults, decode_refuses_a_rig_that_does_not_fit_and_writes_nothing) {
  struct Case {
    const char *rig, *from, *to, *told;
  };
  const std::string code = "-++++-+---++---+";
  for (const Case& c : {Case{"probe", "\"width\": 640", "\"width\": 641", "rig.json says 641 x 480"},
                        Case{"probe", "\"depth_range_mm\": [40", "\"depth_range_mm\": [-40", "near < far"},
                        Case{"probe", "\"depth_range_mm\": [40", "\"depth_range_mm\": [90", "near < far"},
                        Case{"probe", "\"code_ratio\": 7", "\"code_ratio\": 4", "repeats within"},
                        Case{"probe_t", code.c_str(), "-+--++-+--++-+--++", "shows the window"}}) {
    const TempFolder tmp;
    const std::string folder = small_folder(tmp);
    put_rig(folder, c.rig);
    replace_in(folder + "/rig.json", c.from, c.to);
    expect_told(decode(folder, tmp / "out"), 2, c.told);
    EXPECT_FALSE(fs::exists(tmp / "out")) << c.told;
  }
  const TempFolder tmp;
  std::string other = read_file(std::string(ENAMEL_SOURCE_DIR) + "/config/rigs/probe.json").value_or("");
  other.replace(other.find("640"), 3, "320");
  ASSERT_TRUE(write_file(tmp / "other.json", other));
  const std::string folder = small_folder(tmp);
  expect_told(
      run({program("enamel"), "decode", folder, "--burst", "1", "--out", tmp / "out", "--rig", tmp / "other.json"}), 2,
      "the frames of burst 1 are 640 x 480");
  EXPECT_FALSE(fs::exists(tmp / "out"));
}

TEST(Faults, decode_of_frames_without_signal_says_why_and_still_writes_its_report) {
  for (const auto& [level, why] : {std::pair{0, "too_dark"}, {255, "saturated"}, {120, "no_fringes"}}) {
    const TempFolder tmp;
    const std::string folder = small_folder(tmp);
    for (int k = 0; k < 4; ++k) {
      const std::string frame = folder + "/frames/000001_" + std::to_string(k) + ".png";
      ASSERT_TRUE(fs::exists(frame));
      ASSERT_TRUE(cv::imwrite(frame, cv::Mat(480, 640, CV_8U, cv::Scalar(level))));
    }
    const Ran ran = decode(folder, tmp / "out");
    EXPECT_EQ(ran.code, 6) << ran.err;
    EXPECT_NE(ran.err.find(std::string("rejected: ") + why), std::string::npos) << ran.err;
    EXPECT_NE(read_file(tmp / "out/decode.json").value_or("").find(why), std::string::npos);
  }
}

TEST(Faults, unknown_configuration_key_names_line_and_nearest_key) {
  const TempFolder tmp;
  ASSERT_TRUE(write_file(tmp / "c.toml", "[fuse]\nvoxel_mn = 0.1\n"));
  const Ran ran = replay(small_capture(), tmp / "out", {"--config", tmp / "c.toml"});
  expect_told(ran, 2, "c.toml:2");
  EXPECT_NE(ran.err.find("voxel_mm"), std::string::npos) << ran.err;
}

TEST(Faults, configuration_value_out_of_range) {
  const TempFolder tmp;
  expect_told(replay(small_capture(), tmp / "out", {"--set", "fuse.voxel_mm=-1"}), 2, "voxel_mm");
}

TEST(Faults, output_that_cannot_be_written) {
  expect_told(replay(small_capture(), "/proc/nowhere"), 2, "file cannot be written");
}

TEST(Faults, full_disk) {
  const TempFolder tmp;
  // Files may grow to 200 KiB: the mesh does not fit.
  const Ran ran = run({"/bin/bash", "-c",
                       "ulimit -f 200; exec " + program("enamel") + " replay " + small_capture() +
                           " --headless --out " + (tmp / "out")});
  expect_told(ran, 2, "file cannot be written");
  EXPECT_FALSE(fs::exists(tmp / "out/mesh.ply")) << "half-written mesh left behind";
  EXPECT_FALSE(fs::exists(tmp / "out/mesh.ply.partial"));
}

TEST(Faults, view_without_display) {
  const TempFolder tmp;
  const Ran ran = run({"/usr/bin/env", "-u", "DISPLAY", "-u", "WAYLAND_DISPLAY", program("enamel"), "replay",
                       small_capture(), "--out", tmp / "out", "--view"});
  expect_told(ran, 3, "no display");
}

TEST(Faults, burst_that_is_not_there) {
  const TempFolder tmp;
  expect_told(run({program("enamel"), "decode", small_capture(), "--burst", "99999", "--out", tmp / "out"}), 2,
              "no such burst");
}

TEST(Faults, no_probe) {
  const TempFolder tmp;
  expect_told(run({program("enamel"), "scan", "--headless", "--session", tmp / "s", "--dds-tag", unique_tag(),
                   "--wait-seconds", "1"}),
              3, "no probe found");
}

TEST(Faults, a_scene_is_taken_by_its_name_and_an_unknown_one_lists_those_that_are_known) {
  const TempFolder tmp;
  const auto demo = [&](const std::string& scene) {
    return run({program("enamel"), "demo", "--headless", "--scene", scene, "--out", tmp / "out", "--cache", tmp / "c"});
  };
  const Ran unknown = demo("archh");
  expect_told(unknown, 2, "no scene 'archh'");
  for (const char* name : {"arch,", "arch_upper", "edentulous", "gaps", "quadrant"}) {
    EXPECT_NE(unknown.err.find(name), std::string::npos) << name;
  }
  EXPECT_FALSE(fs::exists(tmp / "out"));
  // The name leads to the file: the twin reads it and says why this one cannot be scanned.
  EXPECT_NE(demo("calibration").err.find("path.type = calibration shows a board"), std::string::npos);
  EXPECT_NE(demo("./arch").err.find("./arch"), std::string::npos);  // a path, not a name
  EXPECT_NE(run({program("enamel"), "demo", "--help"}).out.find("a name of config/scenes"), std::string::npos);
}

TEST(Faults, wrong_usage) {
  EXPECT_EQ(run({program("enamel"), "replay"}).code, 1);
  EXPECT_EQ(run({program("enamel"), "nonsense"}).code, 1);
  EXPECT_EQ(run({program("enamel"), "--help"}).code, 0);
}

}  // namespace
}  // namespace enamel::test
