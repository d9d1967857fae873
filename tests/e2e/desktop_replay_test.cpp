// A recorded desktop scan laid again by its stops: the same bits however many threads, and told what is wrong with
// mount, angles and table. One recording is rendered first, by the test render_desktop.
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>

#include "calib/model/mount.hpp"
#include "tests/support/run.hpp"

namespace enamel::test {
namespace {

using Json = nlohmann::json;
using std::chrono::seconds;

constexpr std::size_t kStops = 10;   // of the recording, a burst each
constexpr double kMean_um = 8;       // derived: a burst's noise of 8.5 um, of which fusing leaves a part
constexpr double kLost_deg = 1.8;    // a step of a direct drive
constexpr std::size_t kSlipped = 6;  // the stop at which it is lost

std::string fixture() { return std::string(ENAMEL_BIN_DIR) + "/../fixtures/desktop.mcap"; }

Json report_in(const std::string& folder) {
  return Json::parse(read_file(folder + "/report.json").value_or("{}"), nullptr, false);
}

/// The recording as a folder, so that its tables can be changed: exported once.
class Exported {
 public:
  Exported() { ran = run({program("enamel"), "capture", "export", fixture(), folder_ / "set"}); }
  [[nodiscard]] std::string mount() const { return folder_ / "set/truth/mount_true.json"; }
  [[nodiscard]] std::string axes_folder() const { return folder_ / "set"; }
  [[nodiscard]] std::string axes() const { return read_file(folder_ / "set/axes.csv").value_or(""); }
  /// A copy with another axes.csv.
  void copy_to(const std::string& to, const std::string& axes_csv) const {
    std::filesystem::copy(folder_ / "set", to, std::filesystem::copy_options::recursive);
    EXPECT_TRUE(write_file(to + "/axes.csv", axes_csv));
  }
  Ran ran;

 private:
  TempFolder folder_;
};

const Exported& exported() {
  static const Exported instance;
  return instance;
}

Ran replay(const std::string& input, const std::string& out, std::vector<std::string> more) {
  std::vector<std::string> argv{program("enamel"), "replay", input, "--headless", "--out", out};
  argv.insert(argv.end(), more.begin(), more.end());
  return run(argv, seconds(240));
}

/// Every row after the header is changed or, where nothing is returned, left out.
std::string with_rows(const std::string& csv, const std::function<std::string(std::size_t, const std::string&)>& of) {
  std::istringstream text(csv);
  std::string line, out;
  for (std::size_t row = 0; std::getline(text, line); ++row) {
    const std::string changed = row == 0 ? line : of(row - 1, line);
    if (!changed.empty()) out += changed + "\n";
  }
  return out;
}

TEST(DesktopReplay, every_stop_is_laid_and_the_bits_do_not_depend_on_threads) {
  const TempFolder tmp;
  ASSERT_EQ(exported().ran.code, 0) << exported().ran.err;
  std::string hash;
  for (const char* threads : {"2", "1", "4"}) {
    const std::string out = tmp / (std::string("out") + threads);
    const Ran ran = replay(fixture(), out, {"--mount", exported().mount(), "--threads", threads});
    ASSERT_EQ(ran.code, 0) << ran.err;
    const Json report = report_in(out);
    if (hash.empty()) {
      hash = report["hash"];
      EXPECT_EQ(report["bursts"]["fused"], kStops);
      EXPECT_LT(report["accuracy"]["mean_abs_um"].get<double>(), kMean_um);
      const Json& desktop = report["desktop"];
      EXPECT_EQ(desktop["stops"].size(), kStops);
      EXPECT_TRUE(desktop["slips"].empty()) << desktop["slips"];
      EXPECT_GT(desktop["edges"].get<int>(), 2 * static_cast<int>(kStops));
      EXPECT_EQ(desktop["switched_off"], 0);
      EXPECT_LT(desktop["fine_rms_um"].get<double>(), desktop["by_axes_rms_um"].get<double>());
      for (const char* key : {"pairs", "sigma0", "circles", "mount", "seconds"})
        EXPECT_TRUE(desktop.contains(key)) << key;
    }
    EXPECT_EQ(report["hash"], hash) << threads << " threads";
  }
}

TEST(DesktopReplay, a_lost_step_is_named_with_its_stop) {
  const TempFolder tmp;
  // Less said than moved is as if the table had gone on by itself: both columns of the rotation, from that stop on.
  const std::string axes = with_rows(exported().axes(), [](std::size_t row, const std::string& line) {
    std::istringstream cells(line);
    std::vector<std::string> at;
    for (std::string cell; std::getline(cells, cell, ',');) at.push_back(cell);
    for (const std::size_t column : {1U, 3U}) {
      if (row >= kSlipped) at[column] = std::to_string(std::stod(at[column]) + kLost_deg);
    }
    return at[0] + "," + at[1] + "," + at[2] + "," + at[3] + "," + at[4];
  });
  exported().copy_to(tmp / "set", axes);
  const Ran ran = replay(tmp / "set", tmp / "out", {"--mount", exported().mount()});
  EXPECT_EQ(ran.code, 3) << ran.err;
  EXPECT_NE(ran.err.find("the table is not where it says it is"), std::string::npos) << ran.err;
  EXPECT_NE(ran.err.find("from stop " + std::to_string(kSlipped) + " on the rotation is off"), std::string::npos)
      << ran.err;
  const Json report = report_in(tmp / "out");
  ASSERT_EQ(report["desktop"]["slips"].size(), 1U) << report["desktop"];
  const Json& slip = report["desktop"]["slips"][0];
  EXPECT_EQ(slip["stop"], kSlipped);
  EXPECT_EQ(slip["kind"], "rotation");
  EXPECT_NEAR(slip["rotation_deg"].get<double>(), -kLost_deg, 0.06) << "derived: two angles of 0.01 degrees, 4 sigma";
  EXPECT_EQ(report["bursts"]["fused"], kStops) << "what was taken is kept";
  EXPECT_LT(report["accuracy"]["mean_abs_um"].get<double>(), kMean_um) << "and right";
}

TEST(DesktopReplay, without_a_mount_it_is_a_free_hand_scan_and_says_so) {
  const TempFolder tmp;
  const Ran ran = replay(fixture(), tmp / "out", {"--fast"});
  EXPECT_NE(ran.err.find("free-hand"), std::string::npos) << ran.err;
  EXPECT_FALSE(report_in(tmp / "out").contains("desktop"));
  EXPECT_TRUE(report_in(tmp / "out").contains("hash")) << ran.err;
}

TEST(DesktopReplay, what_is_wrong_with_mount_or_angles_is_told_before_anything_is_laid) {
  const TempFolder tmp;
  const auto refuses = [&](const std::string& input, const std::string& mount, const std::string& words) {
    const Ran ran = replay(input, tmp / "out", {"--mount", mount});
    EXPECT_EQ(ran.code, 2) << ran.err;
    EXPECT_NE(ran.err.find(words), std::string::npos) << ran.err;
    EXPECT_FALSE(std::filesystem::exists(tmp / "out/report.json"));
  };
  auto mount = calib::load_mount(exported().mount());
  ASSERT_TRUE(mount) << mount.error().message();
  mount->serial = "OTHER-7";
  const auto foreign = calib::mount_text(*mount);
  ASSERT_TRUE(foreign && write_file(tmp / "foreign.json", *foreign));
  refuses(fixture(), tmp / "foreign.json", "OTHER-7");
  std::string damaged = *foreign;
  damaged.replace(damaged.find("OTHER-7"), 7, "SIM-001");
  ASSERT_TRUE(write_file(tmp / "damaged.json", damaged));
  refuses(fixture(), tmp / "damaged.json", "description of the mount not usable");
  refuses(fixture(), tmp / "none.json", "none.json");
  const std::string axes = exported().axes();
  exported().copy_to(tmp / "less", with_rows(axes, [](std::size_t row, const std::string& line) {
                       return row == 5 ? std::string() : line;
                     }));
  refuses(tmp / "less", exported().mount(), "no angles of the axes: burst 5");
  std::filesystem::remove(tmp / "less/axes.csv");
  refuses(tmp / "less", exported().mount(), "no angles of the axes");
}

TEST(DesktopReplay, table_and_holder_are_taken_out) {
  const TempFolder tmp;
  const std::vector<std::string> mount{"--mount", exported().mount()};
  const auto and_more = [&](std::vector<std::string> more) {
    more.insert(more.end(), mount.begin(), mount.end());
    return more;
  };
  const Ran same = replay(fixture(), tmp / "same", and_more({"--empty", fixture()}));
  EXPECT_EQ(same.code, 2) << "a table that is as empty as when it was empty";
  EXPECT_NE(same.err.find("no model in view"), std::string::npos) << same.err;
  // Bursts that name another calibration would take nothing out.
  const std::string foreign = tmp / "foreign";
  std::filesystem::copy(exported().axes_folder(), foreign, std::filesystem::copy_options::recursive);
  std::string rig = read_file(foreign + "/rig.json").value_or("");
  ASSERT_FALSE(rig.empty());
  ASSERT_TRUE(write_file(foreign + "/rig.json", rig + " "));
  const Ran other = replay(fixture(), tmp / "other", and_more({"--empty", foreign}));
  EXPECT_EQ(other.code, 2) << other.err;
  EXPECT_NE(other.err.find("calibration of another probe"), std::string::npos) << other.err;
  EXPECT_NE(other.err.find("10 of 10 bursts of the empty table"), std::string::npos) << other.err;
  // The plate's upper side lies 4 mm under the axes' crossing or over it, by how the scene places it; bumps stand out.
  const Ran none = replay(fixture(), tmp / "none", and_more({"--above", "60"}));
  EXPECT_EQ(none.code, 2) << "everything is lower";
  EXPECT_NE(none.err.find("no model in view"), std::string::npos) << none.err;
}

}  // namespace
}  // namespace enamel::test
