// A pause in a scan, with the real program: no burst is thrown away because of where it is, the books balance, the bits
// are the same on any number of workers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/e2e/small_capture.hpp"
#include "tests/support/run.hpp"

namespace enamel::test {
namespace {

namespace fs = std::filesystem;

/// The small capture as an exchange folder, its rows of bursts as `edit` leaves them.
std::string edited_folder(const TempFolder& tmp, const std::function<void(std::vector<std::string>&)>& edit) {
  std::string folder = tmp / "folder";
  EXPECT_EQ(run({program("enamel"), "capture", "export", small_capture(), folder}).code, 0);
  std::istringstream in(read_file(folder + "/bursts.csv").value_or(""));
  std::string head, line;
  std::getline(in, head);
  std::vector<std::string> rows;
  while (std::getline(in, line)) rows.push_back(line);
  edit(rows);
  std::string text = head + "\n";
  for (const std::string& row : rows) text += row + "\n";
  EXPECT_TRUE(write_file(folder + "/bursts.csv", text));
  return folder;
}

nlohmann::json replay(const std::string& folder, const std::string& out, const std::string& workers = "2",
                      const std::string& more = "--headless") {
  const Ran ran = run({program("enamel"), "replay", folder, "--out", out, "--headless", "--threads", workers, more},
                      std::chrono::seconds(200));
  EXPECT_EQ(ran.code, 0) << ran.err;
  return nlohmann::json::parse(read_file(out + "/report.json").value_or("{}"), nullptr, false);
}

long rows_of(const std::string& csv) {
  const std::string text = read_file(csv).value_or("\n");
  return std::count(text.begin(), text.end(), '\n') - 1;
}

/// Every fused burst has a row in the model's table or in that of one segment.
void expect_complete(const nlohmann::json& report, const std::string& out) {
  long rows = rows_of(out + "/poses.csv");
  for (const auto& segment : report.at("segments")) {
    if (segment.at("state") != "apart") continue;
    const std::string folder = out + "/" + segment.at("folder").get<std::string>();
    rows += rows_of(folder + "/poses.csv");
    EXPECT_TRUE(fs::exists(folder + "/mesh.ply"));
  }
  EXPECT_EQ(rows, report.at("bursts").at("fused").get<long>());
}

TEST(SegmentsEndToEnd, a_pause_on_the_way_loses_no_burst_and_gives_the_same_bits_on_any_number_of_workers) {
  const TempFolder tmp;
  // Bursts 10 to 27 never came: 0.6 s, and the hand has turned by 35 degrees meanwhile.
  const std::string folder =
      edited_folder(tmp, [](std::vector<std::string>& rows) { rows.erase(rows.begin() + 10, rows.begin() + 28); });
  const auto report = replay(folder, tmp / "two");
  EXPECT_EQ(report["bursts"]["accepted"], 22);
  EXPECT_EQ(report["bursts"]["fused"], 22) << report["bursts"];
  ASSERT_GE(report["segments"].size(), 1U);
  EXPECT_EQ(report["segments"][0]["first_burst"], 28);
  expect_complete(report, tmp / "two");
  for (const char* workers : {"1", "3"}) {
    EXPECT_EQ(replay(folder, tmp / workers, workers)["hash"], report["hash"]) << workers;
  }
  EXPECT_NE(replay(folder, tmp / "fast", "2", "--fast")["hash"], report["hash"])
      << "negative control: without the refinement the poses are others";
}

/// The four times of a row, moved.
std::string moved_in_time(const std::string& row, std::int64_t by_ns) {
  std::istringstream in(row);
  std::string field, out;
  for (int k = 0; std::getline(in, field, ','); ++k) {
    const bool is_time = k >= 1 && k <= 4;
    out += (k == 0 ? "" : ",") + (is_time ? std::to_string(std::stoll(field) + by_ns) : field);
  }
  return out;
}

TEST(SegmentsEndToEnd, a_clock_that_runs_backwards_is_told_and_nothing_is_lost) {
  const TempFolder tmp;
  const std::string folder = edited_folder(tmp, [](std::vector<std::string>& rows) {
    for (std::size_t n = 20; n < rows.size(); ++n) rows[n] = moved_in_time(rows[n], -900'000'000);
  });
  const auto report = replay(folder, tmp / "out");
  EXPECT_EQ(report["bursts"]["fused"], 40) << report["bursts"];
  ASSERT_EQ(report["segments"].size(), 1U) << report["segments"];
  EXPECT_EQ(report["segments"][0]["first_burst"], 20);
  EXPECT_EQ(report["segments"][0]["state"], "joined");
  EXPECT_THAT(report["notes"].value("clock", ""), testing::HasSubstr("first at burst 20"));
  EXPECT_FALSE(report["notes"].contains("repeated")) << "negative control";
  expect_complete(report, tmp / "out");
}

TEST(SegmentsEndToEnd, a_burst_that_comes_twice_is_told) {
  const TempFolder tmp;
  const std::string folder = edited_folder(tmp, [](std::vector<std::string>& rows) { rows.resize(12); });
  for (int k = 0; k < 4; ++k) {
    const std::string end = "_" + std::to_string(k) + ".png";
    fs::copy_file(folder + "/frames/000007" + end, folder + "/frames/000008" + end,
                  fs::copy_options::overwrite_existing);
  }
  const auto report = replay(folder, tmp / "out");
  EXPECT_EQ(report["bursts"]["fused"], 12) << report["bursts"];
  EXPECT_THAT(report["notes"].value("repeated", ""), testing::HasSubstr("1 burst(s) came twice, first burst 8"));
  expect_complete(report, tmp / "out");
}

TEST(SegmentsEndToEnd, a_smooth_ball_determines_no_motion_and_that_is_said) {
  const TempFolder tmp;
  const std::string scene = tmp / "ball.toml", capture = tmp / "ball.mcap";
  ASSERT_TRUE(write_file(scene, "rig = \"" ENAMEL_SOURCE_DIR R"(/config/rigs/probe.json"
seed = 5
[object]
type = "spheres"
spheres.diameters_mm = [14]
[texture]
amplitude = 0.0
[timing]
burst_rate_hz = 15.0
[path]
type = "views"
[[path.view]]
tilt_x_deg = -12
turn_deg_s = [20, 0, 0]
velocity_mm_s = [3, 0, 0]
bursts = 10
)"));
  ASSERT_EQ(run({program("enamel-twin"), "render", scene, "--out", capture}, std::chrono::seconds(200)).code, 0);
  const auto report = replay(capture, tmp / "out");
  EXPECT_EQ(report["bursts"]["fused"], 10) << "nothing is thrown away";
  EXPECT_GE(report["undetermined"].value("bursts", 0), 8) << report["undetermined"];
  for (const auto& segment : report["segments"]) EXPECT_EQ(segment["state"], "apart") << "no false join";
}

TEST(SegmentsEndToEnd, a_minute_of_rest_and_the_hand_is_found_where_it_was) {
  const TempFolder tmp;
  // Bursts 0 to 19, then, by its clock a minute later, bursts 10 to 19 once more.
  const std::string folder = edited_folder(tmp, [](std::vector<std::string>& rows) {
    rows.resize(20);
    for (int n = 10; n < 20; ++n) {
      std::istringstream in(rows[static_cast<std::size_t>(n)]);
      std::string field, row = std::to_string(n + 10);
      std::getline(in, field, ',');
      for (int k = 0; std::getline(in, field, ','); ++k)
        row += "," + (k < 4 ? std::to_string(std::stoll(field) + 60'000'000'000LL) : field);
      rows.push_back(row);
    }
  });
  for (int n = 10; n < 20; ++n) {
    for (int k = 0; k < 4; ++k) {
      const auto frame = [&](int burst) {
        return folder + "/frames/" + (std::string(6 - std::to_string(burst).size(), '0') + std::to_string(burst)) +
               "_" + std::to_string(k) + ".png";
      };
      fs::copy_file(frame(n), frame(n + 10), fs::copy_options::overwrite_existing);
    }
  }
  const auto report = replay(folder, tmp / "out");
  EXPECT_EQ(report["bursts"]["fused"], 30) << report["bursts"];
  ASSERT_EQ(report["segments"].size(), 1U) << report["segments"];
  EXPECT_EQ(report["segments"][0]["state"], "joined");
  EXPECT_LE(report["segments"][0]["joined_at"].get<int>(), 23) << "three bursts that agree";
  expect_complete(report, tmp / "out");
}

}  // namespace
}  // namespace enamel::test
