#include <gmock/gmock.h>

#include "calib/io/rig_writer.hpp"
#include "calib/model/rig.hpp"
#include "tests/unit/calib/rig_text.hpp"

namespace enamel::calib {
namespace {

using test::kRigText;
using testing::HasSubstr;

const LightInside kLight{{{{0.8, 0.9, 1.0}, {1.1, 1.2, 1.3}, {1.4, 1.5, 1.6}}}, 0.02, 12};

TEST(LightInside, goes_into_a_rig_and_comes_back) {
  const Rig rig = parse_rig(kRigText).value();
  EXPECT_FALSE(rig.light_inside);
  const auto text = with_light_inside(rig, kLight);
  ASSERT_TRUE(text) << text.error().message();
  const Rig again = parse_rig(*text).value();
  ASSERT_TRUE(again.light_inside);
  EXPECT_EQ(again.light_inside->of_enamel, kLight.of_enamel);
  EXPECT_EQ(again.light_inside->bursts, 12);
  EXPECT_TRUE(again.unknown_keys.empty());
  EXPECT_EQ(again.camera.fx, rig.camera.fx);
}

TEST(LightInside, a_section_that_cannot_be_is_refused_with_its_key) {
  const Rig rig = parse_rig(kRigText).value();
  const std::string good = with_light_inside(rig, kLight).value();
  for (const auto& [from, to] :
       std::initializer_list<std::pair<std::string, std::string>>{{"1.2", "0.01"},
                                                                  {"1.2", "\"a\""},
                                                                  {"\"bursts\": 12", "\"bursts\": 0"},
                                                                  {"\"sigma\": 0.02", "\"sigma\": -1"}}) {
    std::string text = good;
    const auto at = text.find(from, text.find("light_inside"));
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    const auto bad = parse_rig(text);
    ASSERT_FALSE(bad) << from;
    EXPECT_THAT(bad.error().detail, HasSubstr("light_inside.")) << from;
  }
}

}  // namespace
}  // namespace enamel::calib
