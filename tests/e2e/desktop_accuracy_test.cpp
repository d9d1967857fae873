// `enamel desktop accuracy` as a process: figures of two small scans, and what it refuses.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "protocol/base/file.hpp"
#include "tests/support/run.hpp"
#include "tests/support/temp_folder.hpp"

namespace enamel {
namespace {

using testing::HasSubstr;

class DesktopAccuracy : public testing::Test {
 protected:
  /// A run's folder with a bumpy square of 12 mm whose right half stands up by so much.
  std::string run_of(const std::string& name, double raised_um, bool simulated = false) const {
    constexpr int kSide = 41;
    std::string vertices, faces;
    for (int i = 0; i < kSide * kSide; ++i) {
      const double x = 0.3 * (i % kSide), y = 0.3 * (i / kSide);
      const double z = std::sin(x) * std::cos(0.7 * y) + 0.02 * x * y + (x > 6 ? 1e-3 * raised_um : 0);
      vertices += std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
    }
    int count = 0;
    for (int i = 0; i < kSide * (kSide - 1); ++i) {
      if (i % kSide == kSide - 1) continue;
      faces += "4 " + std::to_string(i) + " " + std::to_string(i + 1) + " " + std::to_string(i + kSide + 1) + " " +
               std::to_string(i + kSide) + "\n";
      ++count;
    }
    const std::string head = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(kSide * kSide) +
                             "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                             std::to_string(count) + "\nproperty list uchar int vertex_indices\nend_header\n";
    EXPECT_TRUE(make_folder(own_ / name));
    EXPECT_TRUE(write_file(own_ / (name + "/mesh.ply"), head + vertices + faces));
    const std::string report = simulated ? R"({"simulated": true})" : "{}";
    EXPECT_TRUE(write_file(own_ / (name + "/report.json"), report));
    return own_ / name;
  }
  static test::Ran accuracy(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {test::program("enamel"), "desktop", "accuracy"});
    return test::run(arguments, std::chrono::seconds(120));
  }
  test::TempFolder own_;
};

TEST_F(DesktopAccuracy, tells_trueness_and_precision_and_writes_them) {
  const std::string even = run_of("even", 0), raised = run_of("raised", 20, true), out = own_ / "out";
  const test::Ran ran = accuracy({even, raised, "--reference", even + "/mesh.ply", "--out", out, "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto json = nlohmann::json::parse(ran.out);
  EXPECT_LT(json["trueness"]["runs"][0]["p95_um"].get<double>(), 0.1);
  // A step of 20 um between two halves: a fit shares it out or, being robust, lies on one of them.
  const double rms = json["trueness"]["runs"][1]["rms_um"].get<double>();
  EXPECT_GT(rms, 2);
  EXPECT_LT(rms, 20 / std::numbers::sqrt2 + 0.5);
  EXPECT_EQ(json["precision"]["pairs"].size(), 1U);
  EXPECT_GT(json["precision"]["pairs"][0]["rms_um"].get<double>(), 2);
  EXPECT_EQ(json["simulated"], true);
  EXPECT_TRUE(json["artefact"].is_null());
  EXPECT_EQ(nlohmann::json::parse(read_file(out + "/accuracy.json").value_or("{}")), json);
  EXPECT_TRUE(std::filesystem::exists(out + "/deviation.png"));
}

TEST_F(DesktopAccuracy, a_table_for_people_says_what_it_is_not) {
  const test::Ran ran = accuracy({run_of("a", 0), run_of("b", 5, true)});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("SIMULATED"));
  EXPECT_THAT(ran.out, HasSubstr("no test according to"));
  EXPECT_THAT(ran.out, HasSubstr("precision, 1 pair"));
  const test::Ran one = accuracy({own_ / "a", "--reference", own_ / "b/mesh.ply"});
  EXPECT_EQ(one.code, 0) << one.err;
  EXPECT_THAT(one.out, HasSubstr("precision: needs two runs"));
}

TEST_F(DesktopAccuracy, bad_input_is_named) {
  const std::string a = run_of("a", 0);
  const test::Ran alone = accuracy({a});
  EXPECT_EQ(alone.code, 2);
  EXPECT_THAT(alone.err, HasSubstr("precision needs two runs"));
  EXPECT_EQ(accuracy({a, a}).code, 1);
  EXPECT_EQ(accuracy({}).code, 1);
  const test::Ran absent = accuracy({a, own_ / "nowhere"});
  EXPECT_EQ(absent.code, 2);
  EXPECT_THAT(absent.err, HasSubstr("nowhere"));
  ASSERT_TRUE(make_folder(own_ / "bare"));
  EXPECT_THAT(accuracy({a, own_ / "bare"}).err, HasSubstr("mesh.ply"));
  ASSERT_TRUE(write_file(own_ / "artefact.json", R"({"spheres": [{"d_mm": 3.0}, {"d_mm": 3.0}],
                                                     "distances_mm": [[0, 1, 8.0, 0.001]]})"));
  const test::Ran no_ball = accuracy({a, "--artefact", own_ / "artefact.json"});
  EXPECT_EQ(no_ball.code, 2);
  EXPECT_THAT(no_ball.err, HasSubstr("no ball of 3.000 mm"));
  ASSERT_TRUE(write_file(own_ / "artefact.json", "{"));
  EXPECT_EQ(accuracy({a, "--artefact", own_ / "artefact.json"}).code, 2);
}

}  // namespace
}  // namespace enamel
