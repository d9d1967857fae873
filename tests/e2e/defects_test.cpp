// `enamel inspect` of scans of the twin, as processes: a fault is told with its place and a picture, a sound scan is
// not.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/run.hpp"

namespace enamel::test {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

class Defects : public testing::Test {
 protected:
  /// The folder of the finished scan.
  [[nodiscard]] std::string scanned(const std::string& scene) const {
    const std::string taken = own_ / (scene + ".mcap"), out = own_ / scene;
    const Ran rendered =
        run({program("enamel-twin"), "render", std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/" + scene + ".toml",
             "--seed", "5", "--out", taken},
            std::chrono::seconds(400));
    EXPECT_EQ(rendered.code, 0) << rendered.err;
    const Ran laid = run({program("enamel"), "replay", taken, "--out", out, "--headless"}, std::chrono::seconds(200));
    EXPECT_EQ(laid.code, 0) << laid.err;
    return out;
  }
  static Ran inspect(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {program("enamel"), "inspect"});
    return run(arguments, std::chrono::seconds(100));
  }
  TempFolder own_;
};

TEST_F(Defects, of_a_hasty_scan_are_told_and_ringed_and_a_sound_one_has_none) {
  const std::string hasty = scanned("error_reliability"), sound = scanned("error_none");
  const Ran told = inspect({hasty, "--json", "--gate", "--picture", own_ / "again.png"});
  EXPECT_EQ(told.code, 6) << told.err;
  const Json defects = Json::parse(told.out, nullptr, false);
  ASSERT_TRUE(defects.is_array()) << told.out;
  ASSERT_FALSE(defects.empty());
  for (const Json& defect : defects) {
    EXPECT_EQ(defect["class"], "reliability");
    EXPECT_LT(defect["value"].get<double>(), defect["limit"].get<double>()) << "views";
    EXPECT_THAT(defect["words"].get<std::string>(), testing::HasSubstr("again"));
  }
  EXPECT_EQ(defects, Json::parse(read_file(hasty + "/report.json").value_or("{}"))["defects"]);
  EXPECT_TRUE(fs::exists(hasty + "/defects.png"));
  EXPECT_GT(fs::file_size(own_ / "again.png"), 10000U);

  const Ran none = inspect({sound, "--json", "--gate"});
  EXPECT_EQ(none.code, 0) << none.out;
  EXPECT_EQ(Json::parse(none.out, nullptr, false), Json::array());
  EXPECT_FALSE(fs::exists(sound + "/defects.png"));
}

TEST_F(Defects, what_is_no_scan_and_no_marks_are_errors) {
  EXPECT_EQ(inspect({own_ / "nothing"}).code, 2);
  ASSERT_TRUE(write_file(own_ / "mesh.ply",
                         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                         "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                         "end_header\n0 0 48\n1 0 48\n0 1 48\n3 0 1 2\n"));
  ASSERT_TRUE(write_file(own_ / "marks.json", R"({"scan_bodies": "none"})"));
  const Ran ran = inspect({own_ / "mesh.ply", "--marks", own_ / "marks.json"});
  EXPECT_EQ(ran.code, 2) << ran.err;
  EXPECT_THAT(ran.err, testing::HasSubstr("marks.json"));
}

}  // namespace
}  // namespace enamel::test
