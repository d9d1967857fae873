// A known artefact with the real programs: its balls are found in a rendered scan and tie the map; a scan without one
// is not changed; a certificate that cannot be used ends the run before it begins.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/e2e/small_capture.hpp"
#include "tests/support/run.hpp"

namespace enamel::test {
namespace {

constexpr std::chrono::seconds kLong{300};

Ran replay(const std::string& capture, const std::string& out, const std::vector<std::string>& more) {
  std::vector<std::string> command{program("enamel"), "replay", capture, "--out", out, "--headless"};
  command.insert(command.end(), more.begin(), more.end());
  return run(command, kLong);
}

nlohmann::json report_of(const std::string& out) {
  return nlohmann::json::parse(read_file(out + "/report.json").value_or("{}"), nullptr, false);
}

/// Two balls beside the molars, and the stretch of the first pass that sees them.
std::string two_balls(const TempFolder& tmp) {
  std::vector<std::string> command{program("enamel-twin"), "render",
                                   std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/arch_clip.toml", "--out",
                                   tmp / "clip"};
  for (const char* setting :
       {"timing.bursts=15", "path.from_s=5.3", "object.jaw.from_mm=22", "object.jaw.to_mm=54",
        "object.jaw.max_edge_mm=0.2", "artefact.arc_mm=[34, 42]", "artefact.diameters_mm=[3.0]"}) {
    command.insert(command.end(), {"--set", setting});
  }
  const Ran rendered = run(command, kLong);
  EXPECT_EQ(rendered.code, 0) << rendered.err;
  return tmp / "clip";
}

TEST(ArtefactEndToEnd, balls_beside_the_teeth_are_found_and_their_distance_is_the_certified_one) {
  const TempFolder tmp;
  const std::string clip = two_balls(tmp);
  const Ran ran = replay(clip, tmp / "out", {"--artefact", clip + "/artefact.json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto artefact = report_of(tmp / "out").at("map").at("artefact");
  ASSERT_TRUE(artefact.at("used").get<bool>()) << artefact.dump();
  for (const auto& count : artefact.at("sightings")) EXPECT_GE(count.get<int>(), 3);
  ASSERT_EQ(artefact.at("distances").size(), 1U);
  const auto& d = artefact.at("distances")[0];
  EXPECT_NEAR(d.at("before_um").get<double>(), d.at("certified_um").get<double>(), 10);
  EXPECT_TRUE(d.at("held").get<bool>());
  EXPECT_NE(ran.out.find("artefact  "), std::string::npos) << "a line in the table";
}

TEST(ArtefactEndToEnd, a_scan_that_shows_none_is_what_it_is_without_and_says_so) {
  const TempFolder tmp;
  ASSERT_TRUE(write_file(tmp / "clip.json",
                         R"({"spheres": [{"d_mm": 3}, {"d_mm": 3.5}], "distances_mm": [[0, 1, 30, 0.002]]})"));
  ASSERT_EQ(replay(small_capture(), tmp / "with", {"--artefact", tmp / "clip.json"}).code, 0);
  ASSERT_EQ(replay(small_capture(), tmp / "without", {}).code, 0);
  const auto with = report_of(tmp / "with"), without = report_of(tmp / "without");
  EXPECT_EQ(with.at("hash"), without.at("hash"));
  EXPECT_FALSE(with.at("map").at("artefact").at("used").get<bool>());
  EXPECT_NE(with.at("map").at("artefact").at("why_not").get<std::string>().find("0 spheres seen"), std::string::npos);
  EXPECT_FALSE(without.at("map").contains("artefact"));
}

TEST(ArtefactEndToEnd, a_certificate_that_cannot_be_used_ends_the_run_before_it_begins) {
  const TempFolder tmp;
  ASSERT_TRUE(write_file(tmp / "clip.json", R"({"spheres": [{"d_mm": 3}], "distances_mm": []})"));
  const Ran refused = replay(small_capture(), tmp / "out", {"--artefact", tmp / "clip.json"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("clip.json: fewer than two spheres"), std::string::npos) << refused.err;
  EXPECT_EQ(replay(small_capture(), tmp / "out", {"--artefact", tmp / "none.json"}).code, 2);
  EXPECT_EQ(replay(small_capture(), tmp / "out", {"--fast", "--artefact", tmp / "clip.json"}).code, 1);
}

}  // namespace
}  // namespace enamel::test
