// A case from the twin to its placing, as real programs: a patient's lower, upper and bite rendered on the table of a
// desktop mount, laid by their recordings, placed on each other, and compared with the truth.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <array>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/run.hpp"

namespace enamel::test {
namespace {

using Json = nlohmann::json;
using Pose = Eigen::Isometry3d;
namespace fs = std::filesystem;

constexpr double kBite_mm = 0.05;  // what a bite may be off by at its worst point

struct PartScene {
  const char *name, *from_mm, *to_mm, *rot_deg, *swing_deg;
};
constexpr PartScene kLower{"lower", "10", "34", "[-75,-57,-39,-21,-3]", "[-25,10]"};
constexpr PartScene kUpper{"upper", "-34", "-10", "[-177,-159,-141,-123,-105]", "[-25,10]"};
constexpr PartScene kDie{"die", "16", "28", "[-60,-48,-36]", "[-25,0,25]"};
constexpr PartScene kBite{"bite", "10", "34", "[-30,-15,0,15,30]", "[-15,15]"};

Pose pose_of(const Json& rows) {
  Pose T = Pose::Identity();
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) T(r, c) = rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
  return T;
}

Json json_in(const std::string& path) { return Json::parse(read_file(path).value_or("{}"), nullptr, false); }

class TwinCase : public testing::Test {
 protected:
  /// Rendered, and laid as part `name` of a case.
  void scan(const PartScene& part, int seed, const std::string& into, const std::string& name = {}) const {
    const std::string taken = taken_of(part.name, seed);
    std::vector<std::string> render{program("enamel-twin"),
                                    "render",
                                    std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/desktop_" + part.name + ".toml",
                                    "--seed",
                                    std::to_string(seed),
                                    "--out",
                                    taken};
    for (const std::string& set :
         {std::string("object.jaw.max_edge_mm=0.2"), std::string("render.samples_grid=1"),
          std::string("object.jaw.from_mm=") + part.from_mm, std::string("object.jaw.to_mm=") + part.to_mm,
          std::string("mount.rot_deg=") + part.rot_deg, std::string("mount.swing_deg=") + part.swing_deg})
      render.insert(render.end(), {"--set", set});
    const Ran rendered = run(render, std::chrono::seconds(200));
    ASSERT_EQ(rendered.code, 0) << rendered.err;
    const Ran laid = run({program("enamel"), "replay", taken, "--headless", "--mount", taken + "/truth/mount_true.json",
                          "--out", own_ / into + "/" + (name.empty() ? part.name : name)},
                         std::chrono::seconds(200));
    ASSERT_EQ(laid.code, 0) << laid.err;
  }
  [[nodiscard]] std::string taken_of(const std::string& part, int seed) const {
    return own_ / ("taken_" + part + std::to_string(seed));
  }
  /// Of a scan's frame, the camera's with both axes at zero.
  [[nodiscard]] Pose T_scan_model(const std::string& part, int seed) const {
    const Json truth = json_in(taken_of(part, seed) + "/truth/mount_true.json");
    return pose_of(truth["T_camera_table"]) * pose_of(truth["T_table_model"]);
  }
  [[nodiscard]] Json placed(const std::string& folder, int code) const {
    const Ran ran = run({program("enamel"), "desktop", "case", own_ / folder}, std::chrono::seconds(200));
    EXPECT_EQ(ran.code, code) << ran.err;
    return json_in(own_ / folder + "/case.json");
  }
  TempFolder own_;
};

/// Of the placed STL's corners, which are in the bite's frame: how far the part lies from the truth on what it lies on.
double worst_mm(const std::string& stl, const Pose& T_bite_onto, const Pose& T_onto_part, const Pose& T_true) {
  constexpr std::size_t kHeader = 84, kFacet = 50, kNormal = 12;
  const std::string bytes = read_file(stl).value_or("");
  const Pose off = T_true * T_onto_part.inverse();
  double worst = 0;
  for (std::size_t at = kHeader; at + kFacet <= bytes.size(); at += kFacet) {
    Eigen::Vector3f corner;
    std::memcpy(corner.data(), bytes.data() + at + kNormal, sizeof corner);
    const Eigen::Vector3d p = T_bite_onto.inverse() * corner.cast<double>();
    worst = std::max(worst, (off * p - p).norm());
  }
  return worst;
}

TEST_F(TwinCase, jaws_come_together_as_they_bit_and_another_patients_does_not) {
  for (const PartScene& part : {kLower, kUpper, kBite}) scan(part, 1, "case");
  scan(kDie, 1, "case", "die-36");
  scan(kLower, 2, "mixed");
  ASSERT_FALSE(HasFatalFailure());
  const Json truth = json_in(taken_of("bite", 1) + "/truth/scene.json")["objects"][0], found = placed("case", 0);
  ASSERT_EQ(found["placements"].size(), 3U) << found.dump(1);
  for (const Json& placement : found["placements"]) {
    const std::string part = placement["part"], onto = placement["onto"], key = "T_" + onto + "_" + part;
    ASSERT_TRUE(found.contains(key)) << placement;
    const bool on_bite = onto == "bite";
    const Pose T_onto_model = on_bite ? T_scan_model("bite", 1) * pose_of(truth[key]) : T_scan_model(onto, 1);
    const Pose T_true = T_onto_model * T_scan_model(on_bite ? part : "die", 1).inverse();
    const Pose T_bite_onto = on_bite ? Pose::Identity() : pose_of(found["T_bite_" + onto]);
    const double worst = worst_mm(own_ / "case/" + part + ".stl", T_bite_onto, pose_of(found[key]), T_true);
    EXPECT_GT(worst, 0) << part;
    EXPECT_LT(worst, kBite_mm) << part;
    EXPECT_LT(worst, 3e-3 * placement["far_sigma_um"].get<double>()) << placement;
  }
  EXPECT_TRUE(fs::exists(own_ / "case/case.png"));
  // The control: the same bite, and the lower jaw of somebody else.
  for (const char* part : {"bite", "upper"})
    fs::create_directory_symlink(own_ / "case/" + part, own_ / "mixed/" + part);
  const Json mixed = placed("mixed", 6);
  EXPECT_TRUE(mixed.contains("T_bite_upper"));
  EXPECT_FALSE(mixed.contains("T_bite_lower")) << mixed.dump(1);
  EXPECT_FALSE(fs::exists(own_ / "mixed/lower.stl"));
}

}  // namespace
}  // namespace enamel::test
