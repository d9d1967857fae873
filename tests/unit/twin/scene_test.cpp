// Scene files, burst rhythm, paths and tremor; truth in files.
#include <cstring>

#include "tests/unit/twin/twin_fixture.hpp"
#include "tools/twin/truth_files.hpp"

namespace enamel::twin {
namespace {

Result<SceneConfig> parse(const std::string& text) {
  auto reader = ConfigReader::from_text(text, "test.toml");
  if (!reader) return tl::unexpected<Error>(reader.error());
  SceneConfig c;
  bind_scene(*reader, c);
  if (auto done = reader->finish(); !done) return tl::unexpected<Error>(done.error());
  return c;
}

TEST(TwinScene, shipped_scenes_and_their_rig_load) {
  for (const char* name : {"quadrant", "quadrant_small", "arch", "arch_upper", "edentulous", "gaps", "plane", "spheres",
                           "steps", "calibration", "desktop_bar", "desktop_arch", "desktop_board", "mouth",
                           "mouth_arch", "mouth_metal", "mouth_wet"}) {
    const auto scene = load_scene(std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/" + name + ".toml");
    ASSERT_TRUE(scene) << scene.error().message();
    EXPECT_TRUE(calib::load_rig(scene->rig_path)) << scene->rig_path;
  }
}

TEST(TwinScene, quadrant_is_scanned_in_about_ten_seconds) {
  const auto path = [](const char* name) {
    const auto s = *load_scene(std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/" + name);
    const int bursts = make_arch_path(s.arch_path, Arch(ArchShape{}), s.timing)->bursts();
    return std::pair{bursts, bursts / s.timing.burst_rate_hz};
  };
  EXPECT_NEAR(path("quadrant.toml").second, 10.0, 1.5);
  EXPECT_NEAR(path("quadrant_small.toml").first, 40, 5);
}

TEST(TwinScene, overrides_act_like_the_file) {
  const auto scene = load_scene(std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/plane.toml",
                                {"seed=9", "effects.shot_noise=false", "render.samples_grid=3"});
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->seed, 9U);
  EXPECT_FALSE(scene->effects.shot_noise);
  EXPECT_EQ(scene->render.grid, 3);
}

TEST(TwinScene, mistakes_are_named) {
  const std::string view = "[path]\ntype='views'\n[[path.view]]\nbursts=1\n";
  EXPECT_TRUE(parse("[object]\ntype='plane'\n" + view));
  const auto unknown = parse("[object]\ntype='plane'\n[effects]\nshaddow=true\n" + view);
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kConfigUnknownKey);
  const auto misfit = parse("[object]\ntype='plane'\n[path]\ntype='arch'\n[[path.pass]]\nfrom_mm=1.0\n");
  ASSERT_FALSE(misfit);
  EXPECT_EQ(misfit.error().code, ErrorCode::kConfigValue);
  EXPECT_FALSE(parse("[object]\ntype='file'\n" + view));
  EXPECT_FALSE(parse("[object]\ntype='plane'\n[path]\ntype='views'\n"));
  const auto palate = parse("[object]\ntype='jaw'\njaw.palate=true\n" + view);
  ASSERT_FALSE(palate);
  EXPECT_NE(palate.error().message().find("object.jaw.palate"), std::string::npos);
  EXPECT_TRUE(parse("[object]\ntype='jaw'\njaw.side='upper'\njaw.palate=true\n" + view));
  EXPECT_FALSE(parse("[object]\ntype='plane'\n[timing]\nburst_rate_hz=100.0\n" + view));
}

TEST(TwinScene, rig_without_noise_or_with_a_calibration_set_is_refused) {
  calib::Rig rig = testing::probe_rig();
  rig.noise.reset();
  EXPECT_EQ(TwinSource::create(testing::plane_scene(), rig).error().code, ErrorCode::kRigInvalid);
  rig = testing::probe_rig();
  rig.patterns.mode = calib::PatternMode::kMulti;
  EXPECT_EQ(TwinSource::create(testing::plane_scene(), rig).error().code, ErrorCode::kPatternSet);
}

TEST(TwinPath, probe_keeps_its_distance_and_moves_smoothly) {
  const auto scene = *load_scene(std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/quadrant.toml");
  const auto dentition = make_dentition(JawSide::kLower, 7, false, scene.seed);
  const Arch arch(dentition.shape);
  const auto path = make_arch_path(scene.arch_path, arch, scene.timing);
  const double end = path->bursts() / scene.timing.burst_rate_hz;
  const Eigen::Vector3d tip(0, 0, 48);
  Eigen::Vector3d before = path->pose_at(0) * tip;
  for (double t = 0; t < end; t += 0.01) {
    const Pose pose = path->pose_at(t);
    EXPECT_NEAR((pose.linear().transpose() * pose.linear() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
    EXPECT_NEAR(pose.linear().determinant(), 1, 1e-12);
    const Eigen::Vector3d looked_at = pose * tip;
    EXPECT_LE((looked_at - before).norm(), 0.01 * 1.6 * scene.arch_path.speed_mm_s) << t;
    before = looked_at;
  }
}

TEST(TwinPath, probe_looks_beside_the_arch_by_the_offset_of_a_pass) {
  const Arch arch(ArchShape{});
  PassConfig inside{-10, 10, -30, -6};
  inside.offset_mm = -9;
  ArchPathConfig config;
  config.passes = {inside};
  const auto path = make_arch_path(config, arch, {});
  for (double t = 0; t < 1.3; t += 0.1) {
    const double s = inside.from_mm + 15 * t;
    const Eigen::Vector2d at = arch.point(s) - 9 * arch.buccal(s);
    EXPECT_NEAR((path->pose_at(t) * Eigen::Vector3d(0, 0, 48) - Eigen::Vector3d(at.x(), at.y(), -6)).norm(), 0, 1e-9);
  }
}

TEST(TwinPath, arch_is_measured_by_length) {
  const Arch arch(ArchShape{});
  for (double s = -55; s < 55; s += 0.5) {
    EXPECT_NEAR((arch.point(s + 0.1) - arch.point(s)).norm(), 0.1, 1e-3) << s;
    EXPECT_NEAR(arch.tangent(s).dot(arch.buccal(s)), 0, 1e-12);
  }
  EXPECT_GT(arch.buccal(0).y(), 0.99);
  EXPECT_GT(arch.buccal(45).x(), 0.8);
}

TEST(TwinPath, tremor_has_the_stated_size) {
  const TremorConfig config;
  const Tremor tremor(config, 3), other(config, 4);
  double peak = 0, fast = 0, difference = 0;
  for (double t = 0; t < 20; t += 0.005) {
    const Pose a = tremor.displacement(t);
    // About the pivot the rotations do not show.
    const Eigen::Vector3d p = a * Eigen::Vector3d(0, 0, config.pivot_mm) - Eigen::Vector3d(0, 0, config.pivot_mm);
    peak = std::max(peak, p.cwiseAbs().maxCoeff());
    // Half a tremor period apart the slow part has hardly moved.
    const Eigen::Vector3d q =
        tremor.displacement(t + 0.05) * Eigen::Vector3d(0, 0, config.pivot_mm) - Eigen::Vector3d(0, 0, config.pivot_mm);
    fast = std::max(fast, 0.5 * (q - p).cwiseAbs().maxCoeff());
    difference = std::max(difference, (a.matrix() - other.displacement(t).matrix()).norm());
  }
  EXPECT_GT(peak, 0.15);
  EXPECT_LT(peak, 0.55);
  EXPECT_GT(fast, 0.03);
  EXPECT_LT(fast, 0.13);
  EXPECT_GT(difference, 0.05);
}

TEST(TwinTruth, pfm_is_bottom_up_and_poses_unit) {
  const std::string file = pfm({1, 2, 3, 4, 5, 6}, 3, 2);
  ASSERT_EQ(file.substr(0, 12), "Pf\n3 2\n-1.0\n");
  std::array<float, 6> v{};
  ASSERT_EQ(file.size(), 12 + sizeof v);
  std::memcpy(v.data(), file.data() + 12, sizeof v);
  EXPECT_EQ(v, (std::array<float, 6>{4, 5, 6, 1, 2, 3}));
  BurstTruth truth;
  truth.burst_index = 12;
  truth.t_mid_ns = 99;
  truth.T_model_cam.translation() = Eigen::Vector3d(1, 2, 3);
  EXPECT_EQ(poses_row(truth).substr(0, 42), "12,99,1.000000000,2.000000000,3.000000000,");
}

}  // namespace
}  // namespace enamel::twin
