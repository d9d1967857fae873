#include "calib/model/measuring_rig.hpp"

#include <gtest/gtest.h>

#include "tests/unit/calib/rig_text.hpp"

namespace enamel::calib {
namespace {

using test::kRigText;
using test::rig_text_with;

Rig rig_of(const std::string& text) {
  auto rig = parse_rig(text);
  EXPECT_TRUE(rig) << rig.error().message();
  return *rig;
}

std::string with_serial(std::string text, const std::string& serial) {
  return text.replace(text.find('{'), 1, "{\"serial\": \"" + serial + "\", ");
}

TEST(MeasuringRig, takes_optics_of_the_calibration_and_patterns_of_the_device) {
  const Rig device = rig_of(with_serial(kRigText, "A"));
  Rig solved = rig_of(with_serial(rig_text_with("\"fx\": 1707", "\"fx\": 1711"), "A"));
  solved.patterns = {};
  solved.patterns.mode = PatternMode::kMulti;
  solved.depth_range = DepthRange{41, 55};
  const auto rig = measuring_rig(solved, device);
  ASSERT_TRUE(rig) << rig.error().message();
  EXPECT_EQ(rig->camera.fx, 1711);
  EXPECT_EQ(rig->depth_range->near_mm, 41);
  EXPECT_EQ(rig->patterns.mode, PatternMode::kPolarity);
  EXPECT_EQ(rig->patterns.period_px, 24);
  EXPECT_EQ(rig->crc32, device.crc32) << "bursts name the device's own file";
}

TEST(MeasuringRig, refuses_another_probe_and_another_size) {
  const Rig device = rig_of(with_serial(kRigText, "A"));
  const auto foreign = measuring_rig(rig_of(with_serial(kRigText, "B")), device);
  ASSERT_FALSE(foreign);
  EXPECT_EQ(foreign.error().code, ErrorCode::kRigForeign);
  EXPECT_NE(foreign.error().detail.find("probe B"), std::string::npos);
  Rig small = device;
  small.camera.width = 320;
  const auto other = measuring_rig(small, device);
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::kRigInvalid);
  EXPECT_TRUE(measuring_rig(rig_of(kRigText), device)) << "a file without serial is nobody else's";
}

}  // namespace
}  // namespace enamel::calib
