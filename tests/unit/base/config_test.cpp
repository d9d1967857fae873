#include "protocol/base/config.hpp"

#include <gmock/gmock.h>

#include <filesystem>

namespace enamel {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

enum class Mode { kFast, kExact };
constexpr std::array<std::pair<std::string_view, Mode>, 2> kModes = {{{"fast", Mode::kFast}, {"exact", Mode::kExact}}};

struct SampleConfig {
  std::uint64_t seed = 7;
  int count = 3;
  float sigma_dn = 1.5F;
  double step_mm = 0.1;
  bool enabled = true;
  std::string name = "plain";
  std::vector<double> knots_px = {1.0, 2.0};
  std::array<double, 3> offset_mm = {0.0, 0.0, 1.0};
  std::vector<std::string> tags;
  Mode mode = Mode::kFast;
  struct Ball {
    double radius_mm = 1.0;
  };
  std::vector<Ball> balls;
};

SampleConfig bind_sample(ConfigReader& r) {
  SampleConfig c;
  r.bind("count", c.count, {1, 10}, "number of things");
  ConfigReader noise = r.table("noise");
  noise.bind("seed", c.seed, "seed");
  noise.bind("sigma_dn", c.sigma_dn, {0.F, 100.F}, "read noise");
  r.bind("grid.step_mm", c.step_mm, {0.0, 1.0}, "");
  r.bind("grid.enabled", c.enabled, "");
  r.bind("name", c.name, "");
  r.bind("grid.knots_px", c.knots_px, {0.0, 100.0}, "");
  r.bind("grid.offset_mm", c.offset_mm, {-10.0, 10.0}, "");
  r.bind("tags", c.tags, "");
  r.bind("mode", c.mode, kModes, "speed or same bits");
  c.balls.resize(r.table_count("ball"));
  for (std::size_t i = 0; i < c.balls.size(); ++i) {
    r.table("ball", i).bind("radius_mm", c.balls[i].radius_mm, {0.0, 50.0}, "");
  }
  return c;
}

Result<SampleConfig> read(std::string_view text, const std::vector<std::string>& overrides = {}) {
  ENAMEL_TRY_ASSIGN(ConfigReader r, ConfigReader::from_text(text, "test.toml"));
  for (const std::string& s : overrides) ENAMEL_TRY(r.set(s));
  const SampleConfig c = bind_sample(r);
  ENAMEL_TRY(r.finish());
  return c;
}

void expect_error(std::string_view text, ErrorCode code, std::string_view part,
                  const std::vector<std::string>& set = {}) {
  const auto c = read(text, set);
  ASSERT_FALSE(c) << "accepted: " << text;
  EXPECT_EQ(c.error().code, code) << c.error().detail;
  EXPECT_THAT(c.error().detail, HasSubstr(std::string(part)));
}

TEST(Config, reads_every_type) {
  const auto c = read(R"(count = 5
name = "a \"b\""
tags = ["x", "y"]
mode = "exact"
[noise]
seed = 99
sigma_dn = 2
[grid]
step_mm = 0.25
enabled = false
knots_px = [1, 2.5, 3]
offset_mm = [1, 2, -3]
[[ball]]
radius_mm = 4.0
[[ball]]
)");
  ASSERT_TRUE(c) << c.error().detail;
  EXPECT_EQ(c->count, 5);
  EXPECT_EQ(c->name, "a \"b\"");
  EXPECT_EQ(c->tags, (std::vector<std::string>{"x", "y"}));
  EXPECT_EQ(c->mode, Mode::kExact);
  EXPECT_EQ(c->seed, 99U);
  EXPECT_EQ(c->sigma_dn, 2.F);
  EXPECT_EQ(c->step_mm, 0.25);
  EXPECT_FALSE(c->enabled);
  EXPECT_EQ(c->knots_px, (std::vector<double>{1, 2.5, 3}));
  EXPECT_EQ(c->offset_mm, (std::array<double, 3>{1, 2, -3}));
  ASSERT_EQ(c->balls.size(), 2U);
  EXPECT_EQ(c->balls[0].radius_mm, 4.0);
  EXPECT_EQ(c->balls[1].radius_mm, 1.0);
}

TEST(Config, absent_keys_keep_their_defaults) {
  const auto c = read("");
  ASSERT_TRUE(c) << c.error().detail;
  EXPECT_EQ(c->seed, 7U);
  EXPECT_EQ(c->mode, Mode::kFast);
}

TEST(Config, unknown_key_names_file_line_and_nearest_key) {
  expect_error("count = 2\n[noise]\nsead = 4\n", ErrorCode::kConfigUnknownKey,
               "test.toml:3: unknown key 'noise.sead'; did you mean 'noise.seed'?");
}
TEST(Config, key_in_the_wrong_table_is_suggested_where_it_belongs) {
  expect_error("sigma_dn = 4\n", ErrorCode::kConfigUnknownKey, "did you mean 'noise.sigma_dn'?");
}
TEST(Config, key_like_nothing_gets_no_suggestion) {
  const auto c = read("zzzzzzzz = 1");
  ASSERT_FALSE(c);
  EXPECT_THAT(c.error().detail, Not(HasSubstr("did you mean")));
}
TEST(Config, unknown_empty_table_is_refused) {
  expect_error("[noize]\n", ErrorCode::kConfigUnknownKey, "test.toml:1: unknown key 'noize'");
}
TEST(Config, unknown_key_in_array_element_is_refused) {
  expect_error("[[ball]]\n[[ball]]\nradius = 1\n", ErrorCode::kConfigUnknownKey,
               "test.toml:3: unknown key 'ball[1].radius'; did you mean 'ball[].radius_mm'?");
}
TEST(Config, wrong_type_names_line) {
  expect_error("\ncount = \"2\"\n", ErrorCode::kConfigValue, "test.toml:2: 'count' needs an integer, not string");
  expect_error("count = 2.0", ErrorCode::kConfigValue, "needs an integer, not float");
  expect_error("grid.enabled = 1", ErrorCode::kConfigValue, "needs true or false, not integer");
  expect_error("tags = [1]", ErrorCode::kConfigValue, "needs an array of strings");
  expect_error("grid.knots_px = [1, \"a\"]", ErrorCode::kConfigValue, "needs an array of numbers");
  expect_error("ball = 3", ErrorCode::kConfigValue, "must be an array of tables");
  expect_error("[count]\na = 1", ErrorCode::kConfigValue, "must be a value, not a table");
  expect_error("name = 2020-01-01", ErrorCode::kConfigValue, "not date or time");
}
TEST(Config, out_of_range_names_line) {
  expect_error("count = 11", ErrorCode::kConfigValue, "test.toml:1: 'count' is 11, must be from 1 to 10");
  expect_error("noise.seed = -1", ErrorCode::kConfigValue, "'noise.seed' is -1");
  expect_error("grid.step_mm = 1.5", ErrorCode::kConfigValue, "is 1.5, must be from 0.0 to 1.0");
  expect_error("grid.step_mm = nan", ErrorCode::kConfigValue, "needs a finite number");
  expect_error("grid.step_mm = inf", ErrorCode::kConfigValue, "needs a finite number");
  expect_error("grid.knots_px = [1, 101]", ErrorCode::kConfigValue, "holds 101.0");
  expect_error("grid.knots_px = [nan]", ErrorCode::kConfigValue, "holds nan");
  expect_error("grid.offset_mm = [1, 2]", ErrorCode::kConfigValue, "has 2 numbers, must have 3");
  expect_error("mode = \"slow\"", ErrorCode::kConfigValue, "must be one of fast, exact");
}
TEST(Config, syntax_error_names_line) {
  expect_error("count = 2\nname = \"open\ncount = 3", ErrorCode::kConfigSyntax, "test.toml:2");
  expect_error("count = 2\ncount = 3", ErrorCode::kConfigSyntax, "test.toml:2");
}
TEST(Config, quoted_key_cannot_shadow_a_table) {
  expect_error("\"noise.seed\" = 3\n[noise]\nseed = 4", ErrorCode::kConfigSyntax, "given twice");
}

TEST(Config, overrides_beat_the_file) {
  const auto c = read("count = 2\nnoise.seed = 1", {"count=4", "noise.seed=8", "mode=exact", "name=two words"});
  ASSERT_TRUE(c) << c.error().detail;
  EXPECT_EQ(c->count, 4);
  EXPECT_EQ(c->seed, 8U);
  EXPECT_EQ(c->mode, Mode::kExact);
  EXPECT_EQ(c->name, "two words");
}
TEST(Config, an_override_stands_instead_of_what_it_names_and_a_table_adds) {
  const std::string balls = "[[ball]]\nradius_mm = 1.0\n[[ball]]\nradius_mm = 2.0\n";
  const auto none = read(balls, {"ball=[]"});
  ASSERT_TRUE(none) << none.error().message();
  EXPECT_TRUE(none->balls.empty());
  const auto other = read(balls, {"ball=[{radius_mm=7.0}]"});
  ASSERT_TRUE(other) << other.error().message();
  ASSERT_EQ(other->balls.size(), 1U);
  EXPECT_EQ(other->balls[0].radius_mm, 7.0);
  const auto added = read("[noise]\nseed = 99\n[noiseless]\n", {"noise={seed=3}"});
  ASSERT_FALSE(added) << "a key of another name that begins alike stays";
  EXPECT_THAT(added.error().detail, HasSubstr("noiseless"));
  const auto kept = read("[grid]\nknots_px = [1.0]\noffset_mm = [1.0, 2.0, 3.0]\n", {"grid={knots_px=[5.0]}"});
  ASSERT_TRUE(kept) << kept.error().message();
  EXPECT_EQ(kept->offset_mm[1], 2.0);
  EXPECT_EQ(kept->knots_px.front(), 5.0);
  expect_error(balls, ErrorCode::kConfigValue, "must be an array of tables", {"ball=3"});
}

TEST(Config, bad_overrides_are_refused) {
  expect_error("", ErrorCode::kConfigUnknownKey, "--set noise.sead=3: unknown key", {"noise.sead=3"});
  expect_error("", ErrorCode::kConfigValue, "--set count=99: 'count' is 99", {"count=99"});
  expect_error("", ErrorCode::kConfigSyntax, "expected key=value", {"count"});
  expect_error("", ErrorCode::kConfigSyntax, "expected key=value", {"=3"});
  expect_error("", ErrorCode::kConfigSyntax, "one line", {"count=3\nname=4"});
}

TEST(Config, first_error_is_kept) { expect_error("name = 1\ncount = 11", ErrorCode::kConfigValue, "'count'"); }
TEST(Config, module_can_reject_contradicting_values) {
  auto r = *ConfigReader::from_text("a = 3\nb = 2", "test.toml");
  int a = 0;
  int b = 0;
  r.bind("a", a, "");
  r.bind("b", b, "");
  if (a > b) r.reject("a", "must not exceed b");
  EXPECT_EQ(r.finish().error().detail, "test.toml:1: 'a' must not exceed b");
}
TEST(Config, binding_a_key_twice_is_our_defect) {
  ConfigReader r = ConfigReader::empty();
  int a = 0;
  r.bind("a", a, "");
  r.bind("a", a, "");
  EXPECT_EQ(r.finish().error().code, ErrorCode::kInternal);
}

TEST(Config, dump_reads_back_to_the_same_dump) {
  auto r = *ConfigReader::from_text("count = 5\n[[ball]]\nradius_mm=0.1\n[[ball]]\n[noise]\nsigma_dn = 0.1", "a.toml");
  bind_sample(r);
  ASSERT_TRUE(r.finish());
  const std::string text = r.dump();
  EXPECT_THAT(text, HasSubstr("count = 5  # number of things; from 1 to 10\n"));
  EXPECT_THAT(text, HasSubstr("[noise]\nseed = 7"));
  EXPECT_THAT(text, HasSubstr("sigma_dn = 0.1 "));
  EXPECT_THAT(text, HasSubstr("[[ball]]\nradius_mm = 0.1"));
  auto again = ConfigReader::from_text(text, "b.toml");
  ASSERT_TRUE(again) << again.error().detail << "\n" << text;
  bind_sample(*again);
  ASSERT_TRUE(again->finish()) << again->finish().error().detail;
  EXPECT_EQ(again->dump(), text);
}
TEST(Config, dump_keeps_table_elements_apart) {
  auto r = *ConfigReader::from_text("[[o]]\np.x = 1\n[[o]]\np.x = 2\ny=3", "a.toml");
  for (std::size_t i = 0; i < r.table_count("o"); ++i) {
    double x = 0;
    int y = 0;
    r.table("o", i).bind("p.x", x, "");
    r.table("o", i).bind("y", y, "");
  }
  ASSERT_TRUE(r.finish());
  EXPECT_EQ(r.dump(), "[[o]]\ny = 0\n\n[o.p]\nx = 1.0\n\n[[o]]\ny = 3\n\n[o.p]\nx = 2.0\n");
}

TEST(Config, missing_file_and_folder_are_errors) {
  EXPECT_EQ(ConfigReader::from_file("/nonexistent/x.toml").error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(ConfigReader::from_file(std::filesystem::temp_directory_path()).error().code, ErrorCode::kFileRead);
}

TEST(Config, hostile_text_never_crashes) {
  for (const std::string& text : {std::string(5000, '['), std::string("a=") + std::string(5000, '['),
                                  std::string("\0\1\2", 3), std::string("a.\"b\".c = {"), std::string("\xff\xfe")}) {
    EXPECT_FALSE(read(text));
  }
}

}  // namespace
}  // namespace enamel
