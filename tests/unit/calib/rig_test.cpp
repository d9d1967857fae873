#include "calib/model/rig.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <span>

#include "protocol/base/crc32.hpp"
#include "tests/unit/calib/rig_text.hpp"

namespace enamel::calib {
namespace {

using test::kRigText;
using test::rig_text_with;

TEST(Rig, reads_every_value_of_a_valid_file) {
  const auto rig = parse_rig(kRigText);
  ASSERT_TRUE(rig) << rig.error().message();
  EXPECT_EQ(rig->camera.width, 640);
  EXPECT_EQ(rig->camera.fy, 1706.5);
  EXPECT_EQ(rig->camera.dist[3], -0.0002);
  EXPECT_EQ(rig->projector.cx, 425.2);
  EXPECT_EQ(rig->T_proj_cam[2][3], 1.8305878417255612);
  EXPECT_EQ(rig->patterns.mode, PatternMode::kPolarity);
  ASSERT_EQ(rig->patterns.polarity_code.size(), 16U);
  EXPECT_EQ(rig->patterns.polarity_code[0], -1);
  EXPECT_EQ(rig->patterns.polarity_code[1], 1);
  EXPECT_EQ(rig->patterns.mean, 127.0);
  EXPECT_EQ(rig->depth_range->far_mm, 56);
  EXPECT_EQ(rig->noise->gain_e_per_dn, 39.84);
  EXPECT_TRUE(rig->unknown_keys.empty());
}

TEST(Rig, keeps_text_byte_for_byte_with_its_crc) {
  const std::string text = " \n" + kRigText + "\n\n";
  const auto rig = parse_rig(text);
  ASSERT_TRUE(rig);
  EXPECT_EQ(rig->text, text);
  EXPECT_EQ(rig->crc32, enamel::crc32(std::as_bytes(std::span<const char>(text))));
}

TEST(Rig, names_unknown_keys_and_accepts_them) {
  const auto rig =
      parse_rig(rig_text_with(R"("units": "mm")", R"("units": "mm", "nominal": true, "origin": {"a": [1]})"));
  ASSERT_TRUE(rig);
  EXPECT_THAT(rig->unknown_keys, testing::UnorderedElementsAre("nominal", "origin"));
  const auto nested = parse_rig(rig_text_with(R"("black_dn": 4)", R"("black_dn": 4, "averaged_frames": 16)"));
  ASSERT_TRUE(nested);
  EXPECT_THAT(nested->unknown_keys, testing::ElementsAre("noise.averaged_frames"));
}

TEST(Rig, absent_optional_parts_stay_absent) {
  const std::string text = kRigText.substr(0, kRigText.find(",\n \"depth_range_mm\"")) + "}";
  const auto rig = parse_rig(text);
  ASSERT_TRUE(rig) << rig.error().message();
  EXPECT_FALSE(rig->depth_range);
  EXPECT_FALSE(rig->noise);
}

struct BadEdit {
  const char* from;
  const char* to;
  const char* named;
};

class BadRig : public testing::TestWithParam<BadEdit> {};

TEST_P(BadRig, is_refused_with_the_key_named) {
  const std::string text = rig_text_with(GetParam().from, GetParam().to);
  ASSERT_FALSE(text.empty());
  const auto rig = parse_rig(text);
  ASSERT_FALSE(rig);
  EXPECT_EQ(rig.error().code, ErrorCode::kRigInvalid);
  EXPECT_THAT(rig.error().detail, testing::HasSubstr(GetParam().named));
}

INSTANTIATE_TEST_SUITE_P(
    Edits, BadRig,
    testing::Values(BadEdit{"\"fx\": 1707", "\"fx\": NaN", "not valid JSON"},
                    BadEdit{"\"fx\": 1707", "\"fx\": 1e999", "not valid JSON"},
                    BadEdit{"\"fx\": 1707", "\"fx\": 1707, \"fx\": 1708", "key 'fx' is written twice"},
                    BadEdit{"\"fx\": 1707", "\"fx\": \"1707\"", "camera.fx"},
                    BadEdit{"\"fx\": 1707", "\"fx\": null", "camera.fx"},
                    BadEdit{"\"fx\": 1707", "\"fx\": 0", "camera.fx"}, BadEdit{"\"fx\": 1707,", "", "camera.fx"},
                    BadEdit{"\"width\": 640", "\"width\": 640.5", "camera.width"},
                    BadEdit{"\"width\": 640", "\"width\": -640", "camera.width"},
                    BadEdit{"-0.0002, 0.0]", "-0.0002]", "camera.dist"},
                    BadEdit{"\"format\": \"rig/1\"", "\"format\": \"rig/9\"", "format"},
                    BadEdit{"\"units\": \"mm\"", "\"units\": \"inch\"", "units"},
                    BadEdit{"[[0.97807", "[[0.87807", "T_proj_cam"}, BadEdit{"[0,0,0,1]]", "[0,0,0,2]]", "T_proj_cam"},
                    BadEdit{",[0,0,0,1]]", "]", "T_proj_cam"}, BadEdit{"[0,0,0,1]]", "[0,0,0,1],[1]]", "T_proj_cam"},
                    BadEdit{"\"mode\": \"T\"", "\"mode\": \"Q\"", "patterns.mode"},
                    BadEdit{"\"period_px\": 24.0", "\"period_px\": -24", "patterns.period_px"},
                    BadEdit{"\"period_px\": 24.0,", "", "patterns.period_px"},
                    BadEdit{"\"-++++-+---++---+\"", "\"-+x\"", "patterns.polarity_code"},
                    BadEdit{"\"-++++-+---++---+\"", "\"\"", "patterns.polarity_code"},
                    BadEdit{"\"axis\": \"u\"", "\"axis\": \"w\"", "patterns.axis"},
                    BadEdit{"\"steps\": 4", "\"steps\": 3", "patterns.steps"},
                    BadEdit{"[40, 56]", "[56, 40]", "depth_range_mm"}, BadEdit{"[40, 56]", "[40]", "depth_range_mm"},
                    BadEdit{"\"gain_e_per_dn\": 39.84", "\"gain_e_per_dn\": 0", "noise.gain_e_per_dn"},
                    BadEdit{"\"black_dn\": 4}", "\"black_dn\": []}", "noise.black_dn"},
                    BadEdit{"\"black_dn\": 4}", "\"black_dn\": 256}", "noise.black_dn"},
                    BadEdit{"\"gain_e_per_dn\": 39.84", "\"gain_e_per_dn\": 1e9", "noise.gain_e_per_dn"},
                    BadEdit{"\"fx\": 1707", "\"fx\": 1e9", "camera.fx"},
                    BadEdit{"\"fx\": 1707", "\"fx\": 170", "camera.fy"},
                    BadEdit{"-0.0002, 0.0]", "-0.0002, 1e9]", "camera.dist"},
                    BadEdit{"-0.0002, 0.0]", "-0.0002, -1e308]", "camera.dist"},
                    BadEdit{"\"cx\": 425.2", "\"cx\": 1e9", "projector.cx"}));

/// The limits are far from any lens: a narrow one whose coefficients are large, and a projector that throws upwards.
TEST(Rig, unusual_lenses_are_read) {
  EXPECT_TRUE(parse_rig(rig_text_with("-0.0002, 0.0]", "-0.0002, 500.0]")));
  EXPECT_TRUE(parse_rig(rig_text_with("\"cx\": 425.2", "\"cx\": -2000")));
}

const std::string kModeT = "\"mode\": \"T\", \"axis\": \"u\", \"period_px\": 24.0, \"steps\": 4";

TEST(Rig, mode_m_needs_three_steps_and_a_code_ratio) {
  const auto with = [](const std::string& rest) {
    return parse_rig(rig_text_with(kModeT, "\"mode\": \"M\", \"axis\": \"u\", \"period_px\": 24.0" + rest));
  };
  const auto rig = with(", \"steps\": 3, \"code_ratio\": 6");
  ASSERT_TRUE(rig) << rig.error().detail;
  EXPECT_EQ(rig->patterns.mode, PatternMode::kMicro);
  EXPECT_EQ(rig->patterns.steps, 3);
  EXPECT_EQ(rig->patterns.code_ratio, 6.0);
  for (const auto& [rest, key] : {std::pair{", \"steps\": 4, \"code_ratio\": 6", "patterns.steps"},
                                  std::pair{", \"steps\": 3", "patterns.code_ratio"},
                                  std::pair{", \"steps\": 3, \"code_ratio\": 1", "patterns.code_ratio"},
                                  std::pair{", \"steps\": 3, \"code_ratio\": \"6\"", "patterns.code_ratio"}}) {
    const auto bad = with(rest);
    ASSERT_FALSE(bad) << rest;
    EXPECT_EQ(bad.error().code, ErrorCode::kRigInvalid);
    EXPECT_THAT(bad.error().detail, testing::HasSubstr(key));
  }
}

TEST(Rig, any_truncation_is_refused_and_never_crashes) {
  for (std::size_t n = 0; n < kRigText.size(); n += 7) {
    const auto rig = parse_rig(kRigText.substr(0, n));
    ASSERT_FALSE(rig) << n;
    EXPECT_EQ(rig.error().code, ErrorCode::kRigInvalid);
  }
  EXPECT_FALSE(parse_rig("[]"));
  EXPECT_FALSE(parse_rig(std::string("\0\xff\xfe", 3)));
}

TEST(Rig, load_distinguishes_a_missing_file_from_a_bad_one) {
  EXPECT_EQ(load_rig("/nonexistent/rig.json").error().code, ErrorCode::kFileNotFound);
  const std::string path = testing::TempDir() + "enamel_bad_rig.json";
  std::ofstream(path) << "{";
  const auto rig = load_rig(path);
  ASSERT_FALSE(rig);
  EXPECT_EQ(rig.error().code, ErrorCode::kRigInvalid);
  EXPECT_THAT(rig.error().detail, testing::HasSubstr(path));
}

}  // namespace
}  // namespace enamel::calib
