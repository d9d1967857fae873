// `enamel calibrate ceramic` on the twin's tile: what it finds, and what decoding makes of it.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>

#include "protocol/base/file.hpp"
#include "tests/support/run.hpp"
#include "tests/support/temp_folder.hpp"

namespace enamel {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class CeramicCommand : public testing::Test {
 protected:
  [[nodiscard]] std::string tile(const std::vector<std::string>& sets) const {
    std::vector<std::string> words{test::program("enamel-twin"), "render",
                                   std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/ceramic.toml", "--out",
                                   own_ / "tile.mcap"};
    for (const std::string& set : sets) words.insert(words.end(), {"--set", set});
    EXPECT_EQ(test::run(words, std::chrono::seconds(240)).code, 0);
    return own_ / "tile.mcap";
  }
  [[nodiscard]] test::Ran calibrate(const std::string& capture, const std::string& rig, const std::string& out) const {
    return test::run({test::program("enamel"), "calibrate", "ceramic", capture, "--rig", rig, "--out", out, "--json"},
                     std::chrono::seconds(120));
  }
  const std::string rig_ = std::string(ENAMEL_SOURCE_DIR) + "/config/rigs/probe.json";
  test::TempFolder own_;
};

TEST_F(CeramicCommand, measures_the_field_and_decoding_goes_by_it) {
  const std::string capture = tile({}), out = own_ / "rig.json";
  const test::Ran ran = calibrate(capture, rig_, out);
  ASSERT_EQ(ran.code, 0) << ran.err;
  const json found = json::parse(ran.out);
  EXPECT_GE(found["used"].get<int>(), 10);
  const auto& um = found["ceramic_beyond_frame_um"];
  EXPECT_GT(um["as_it_is"].get<double>(), 20);
  EXPECT_LT(um["now"].get<double>(), 0.75 * um["by_enamel"].get<double>());
  // Light and view meet a surface before the right edge, away from the projector's side, at less of an angle to each
  // other's sines: a tenth less deep (docs/mouth.md, what bends an arch).
  const auto& share = found["of_enamel"];
  EXPECT_NEAR(share[1][2].get<double>() / share[1][1].get<double>(), 0.90, 0.05);
  EXPECT_NEAR(share[1][0].get<double>() / share[1][1].get<double>(), 1.02, 0.05);
  // Measured again with the rig that was made: enamel's law is asked as before, so the shares are the same.
  const test::Ran again = calibrate(capture, out, own_ / "again.json");
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(json::parse(again.out)["of_enamel"], share);
  const auto depth_of = [&](const std::string& rig, const std::string& folder) {
    const test::Ran decoded =
        test::run({test::program("enamel"), "decode", capture, "--burst", "0", "--rig", rig, "--out", own_ / folder},
                  std::chrono::seconds(60));
    EXPECT_EQ(decoded.code, 0) << decoded.err;
    return read_file(std::string(own_ / folder) + "/depth.pfm").value_or("");
  };
  EXPECT_NE(depth_of(rig_, "enamel"), depth_of(out, "calibrated"));
}

TEST_F(CeramicCommand, plaster_alone_is_no_ceramic) {
  const test::Ran ran = calibrate(tile({"object.material=plaster"}), rig_, own_ / "rig.json");
  EXPECT_NE(ran.code, 0);
  EXPECT_THAT(ran.err, HasSubstr("show frame and ceramic"));
  EXPECT_FALSE(read_file(own_ / "rig.json"));
}

}  // namespace
}  // namespace enamel
