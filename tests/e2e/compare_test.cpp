// `enamel compare` as a process: what it says beside its figures, and that a gate is not passed by meaningless ones.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "protocol/base/file.hpp"
#include "tests/support/run.hpp"
#include "tests/support/temp_folder.hpp"

namespace enamel {
namespace {

using testing::HasSubstr;

class CompareCommand : public testing::Test {
 protected:
  /// A bumpy square, 12 mm wide, every coordinate times `factor` after `away` was added along x.
  std::string sheet(const std::string& name, double factor, double away_mm = 0, const std::string& more = "") const {
    constexpr int kSide = 20;
    std::string text;
    for (int i = 0; i < kSide * kSide; ++i) {
      const double x = 0.6 * (i % kSide), y = 0.6 * (i / kSide), z = std::sin(x) * std::cos(0.7 * y);
      text += "v";
      for (const double c : {x + away_mm, y, z}) text += " " + std::to_string(c * factor);
      text += "\n";
    }
    for (int i = 1; i < kSide * (kSide - 1); ++i) {
      if (i % kSide == 0) continue;
      text += "f " + std::to_string(i) + " " + std::to_string(i + 1) + " \\\n " + std::to_string(i + kSide + 1) + " " +
              std::to_string(i + kSide) + "\n";
    }
    EXPECT_TRUE(write_file(own_ / name, text + more));
    return own_ / name;
  }
  static test::Ran compare(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {test::program("enamel"), "compare"});
    return test::run(arguments, std::chrono::seconds(60));
  }
  test::TempFolder own_;
};

TEST_F(CompareCommand, another_unit_is_told_and_passes_no_gate) {
  const std::string scan = sheet("scan.obj", 1), metres = sheet("metres.obj", 1e-3);
  const test::Ran told = compare({scan, metres});
  EXPECT_EQ(told.code, 0);
  EXPECT_THAT(told.err, HasSubstr("metres.obj: "));
  EXPECT_THAT(told.err, HasSubstr("metres (times 1000)"));
  EXPECT_EQ(compare({metres, metres, "--max-mean-um", "10"}).code, 6);
  // Control: the same in mm.
  const test::Ran good = compare({scan, scan, "--max-mean-um", "10"});
  EXPECT_EQ(good.code, 0);
  EXPECT_EQ(good.err, "");
}

TEST_F(CompareCommand, a_mouth_in_micrometres_takes_seconds) {
  EXPECT_THAT(compare({sheet("a.obj", 1e3), sheet("b.obj", 1e3)}).err, HasSubstr("micrometres (times 0.001)"));
}

TEST_F(CompareCommand, what_was_left_out_is_told_and_counted) {
  const std::string scan = sheet("scan.obj", 1),
                    dirty = sheet("dirty.obj", 1, 0, "v nan 0 0\nf 1 2 401\nf 1 1 2\nf 3 4\n");
  const test::Ran told = compare({scan, dirty, "--json"});
  EXPECT_EQ(told.code, 0);
  EXPECT_THAT(told.err, HasSubstr("dirty.obj: left out: 1 vertex without a finite position, 1 face with such a corner, "
                                  "2 faces without area"));
  const auto j = nlohmann::json::parse(told.out);
  EXPECT_EQ(j["left_out"]["reference"]["flat_faces"], 2);
  EXPECT_EQ(j["warnings"].size(), 1U);
  EXPECT_LT(j["mean_abs_um"].get<double>(), 0.1);
}

TEST_F(CompareCommand, a_deviation_picture_far_out_lies_where_the_mesh_does) {
  const std::string far = sheet("far.obj", 1, 700000);
  const test::Ran first = compare({far, far, "--out", own_ / "out"});
  EXPECT_EQ(first.code, 0) << first.err;
  const test::Ran again = compare({own_ / "out/deviation.ply", far, "--json"});
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_LT(nlohmann::json::parse(again.out)["max_um"].get<double>(), 0.1);
}

}  // namespace
}  // namespace enamel
