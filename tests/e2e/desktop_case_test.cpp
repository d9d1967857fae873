// `enamel desktop case`, `base` and `scan --part` as processes: a case of drawn jaws, its placing, and what is refused.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "calib/model/mount.hpp"
#include "host/mesh_files/mesh_file.hpp"
#include "protocol/base/file.hpp"
#include "tests/support/run.hpp"
#include "tests/support/temp_folder.hpp"
#include "tests/unit/host/drawn_jaws.hpp"

namespace enamel {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class DesktopCase : public testing::Test {
 protected:
  std::string add_part(const std::string& name, const Mesh& mesh) const {
    const std::string folder = own_ / ("case/" + name);
    EXPECT_TRUE(make_folder(folder));
    EXPECT_TRUE(host::write_mesh(folder + "/mesh.ply", mesh));
    EXPECT_TRUE(write_file(folder + "/report.json", R"({"simulated": true, "calibration": {"serial": "H-1"}})"));
    return folder;
  }
  static test::Ran desktop(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {test::program("enamel"), "desktop"});
    return test::run(arguments, std::chrono::seconds(300));
  }
  test::TempFolder own_;
};

Mesh lower_jaw(std::uint64_t seed, double edge_mm) {
  return host::jaw_mesh(twin::JawSide::kLower, seed, edge_mm, 4, 30);
}

bool from_above(const Vec3d& /*at*/, const Vec3d& normal) { return normal.z() > -0.3; }

TEST_F(DesktopCase, jaw_is_laid_on_the_bite_and_another_patients_is_not) {
  std::mt19937 draw(3);
  const Pose T_lower = host::drawn_pose(draw), T_bite = host::drawn_pose(draw);
  add_part("lower", host::scanned(lower_jaw(4, 0.3), from_above, 0.006, 1, T_lower));
  add_part("upper", host::scanned(lower_jaw(5, 0.3), from_above, 0.006, 2, T_lower));  // whoever's it is
  add_part("bite", host::scanned(lower_jaw(4, 0.27), host::from_the_cheek, 0.006, 3, T_bite));
  add_part("die-99", lower_jaw(4, 0.6));  // there is no such tooth
  const test::Ran ran = desktop({"case", own_ / "case", "--json"});
  EXPECT_EQ(ran.code, 6) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("not placed: upper:"));
  const auto json = nlohmann::json::parse(read_file(own_ / "case/case.json").value_or("{}"));
  EXPECT_EQ(nlohmann::json::parse(ran.out), json);
  ASSERT_EQ(json["warnings"].size(), 1U) << json["warnings"];
  EXPECT_THAT(json["warnings"][0].get<std::string>(), HasSubstr("die-99: a part is"));
  EXPECT_FALSE(json.contains("T_bite_upper"));
  ASSERT_TRUE(json.contains("T_bite_lower")) << json.dump(1);
  Pose T = Pose::Identity();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c)
      T(r, c) = json["T_bite_lower"][static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
  const Pose off = T_bite.inverse() * T * T_lower;
  for (const Vec3d& corner : {Vec3d(30, 0, 0), Vec3d(0, -30, 0), Vec3d(0, 0, 10)})
    EXPECT_LT((off * corner - corner).norm(), 0.03);
  EXPECT_TRUE(fs::exists(fs::path(own_ / "case/lower.stl")));
  EXPECT_FALSE(fs::exists(fs::path(own_ / "case/upper.stl")));
  EXPECT_TRUE(fs::exists(fs::path(own_ / "case/case.png")));
}

TEST_F(DesktopCase, folder_without_parts_is_told) {
  EXPECT_TRUE(make_folder(own_ / "case"));
  const test::Ran ran = desktop({"case", own_ / "case"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.err, HasSubstr("--part"));
  EXPECT_EQ(desktop({"case", own_ / "none"}).code, 2);
}

TEST_F(DesktopCase, part_that_was_scanned_is_kept) {
  const std::string folder = add_part("lower", lower_jaw(4, 0.6)), mount = own_ / "mount.json";
  calib::Mount table;
  table.serial = "M-1";
  table.rotation.direction = {0, 0, -1};
  table.rotation.point_mm = {27, 0, 48};
  table.swing.direction = {0, 1, 0};
  table.swing.point_mm = {0, 0, 48};
  ASSERT_TRUE(write_file(mount, calib::mount_text(table).value_or("")));
  const std::string kept = read_file(folder + "/mesh.ply").value_or("");
  const std::vector<std::string> scan{"scan",    "--part", "lower",  "--out",          own_ / "case",
                                      "--mount", mount,    "--port", own_ / "no-port", "--headless"};
  const test::Ran refused = desktop(scan);
  EXPECT_EQ(refused.code, 2) << refused.err;
  EXPECT_THAT(refused.err, HasSubstr("--again"));
  std::vector<std::string> again = scan;
  again.emplace_back("--again");
  const test::Ran failed = desktop(again);  // there is no table: the old scan is put back
  EXPECT_EQ(failed.code, 3) << failed.err;
  EXPECT_EQ(read_file(folder + "/mesh.ply").value_or("gone"), kept);
  EXPECT_FALSE(fs::exists(folder + ".1"));
  std::vector<std::string> other = scan;
  other[2] = "nose";
  EXPECT_EQ(desktop(other).code, 1);
}

TEST_F(DesktopCase, base_is_tagged_and_measurements_leave_it_out) {
  const std::string run = add_part("lower", host::scanned(lower_jaw(4, 0.4), from_above, 0, 1, Pose::Identity()));
  const test::Ran based = desktop({"base", run, "--up", "0", "0", "1", "--json"});
  ASSERT_EQ(based.code, 0) << based.err;
  const auto json = nlohmann::json::parse(based.out);
  EXPECT_EQ(json["watertight"], true);
  EXPECT_GT(json["volume_mm3"].get<double>(), 100);
  EXPECT_EQ(nlohmann::json::parse(read_file(run + "/report.json").value_or("{}"))["base"], json);
  EXPECT_TRUE(fs::exists(run + "/closed.stl"));
  const test::Ran compared =
      test::run({test::program("enamel"), "compare", run + "/closed.ply", run + "/mesh.ply", "--json"},
                std::chrono::seconds(120));
  ASSERT_EQ(compared.code, 0) << compared.err;
  const auto figures = nlohmann::json::parse(compared.out);
  EXPECT_EQ(figures["left_out"]["mesh"]["synthetic_faces"], json["synthetic_faces"]);
  EXPECT_LT(figures["max_um"].get<double>(), 0.5);
  // The control: as an STL it has no tags, and its bottom lies millimetres off.
  const test::Ran untagged =
      test::run({test::program("enamel"), "compare", run + "/closed.stl", run + "/mesh.ply", "--json"},
                std::chrono::seconds(120));
  EXPECT_GT(nlohmann::json::parse(untagged.out)["max_um"].get<double>(), 500);
  EXPECT_EQ(desktop({"base", run + "/mesh.ply"}).code, 1);  // where to?
  EXPECT_EQ(desktop({"base", run + "/mesh.ply", "--out", run + "/mesh.ply"}).code, 1);
}

}  // namespace
}  // namespace enamel
