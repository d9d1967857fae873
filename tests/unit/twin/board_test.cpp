// A calibration board before the probe: stands, patterns, averaged frames, and the still renderer beside the one for
// scans.
#include <algorithm>
#include <numbers>

#include "tests/unit/twin/twin_fixture.hpp"
#include "tools/twin/board/board_poses.hpp"
#include "tools/twin/board/board_source.hpp"
#include "tools/twin/board/nominal_rig.hpp"
#include "tools/twin/render/still_renderer.hpp"

namespace enamel::twin::testing {
namespace {

SensorConfig sensor() { return {}; }

TEST(FrameAverager, has_the_mean_and_variance_of_single_exposures) {
  const SensorConfig config = sensor();
  const FrameAverager averager(config, 1);
  for (const double mean_e : {0.5, 15.0, 60.0, 400.0, 3000.0, 9000.0, 9990.0}) {
    constexpr std::size_t kPixels = 200'000;
    const auto bytes = digitise(std::vector<float>(kPixels, static_cast<float>(mean_e)), config, {5, 1, 0});
    double sum = 0, squares = 0;
    for (const std::uint8_t b : bytes) {
      sum += b;
      squares += double(b) * double(b);
    }
    const double mean = sum / kPixels, variance = squares / kPixels - mean * mean;
    const SampleMoments m = averager.moments(mean_e);
    EXPECT_NEAR(m.mean, mean, 5 * std::sqrt(variance / kPixels) + 0.003) << mean_e;
    EXPECT_NEAR(m.variance, variance, 0.02 * variance + 0.002) << mean_e;
  }
}

TEST(FrameAverager, sixteen_frames_have_a_quarter_of_the_noise) {
  const std::vector<float> light(100'000, 3000.0F);
  const auto scatter = [&](int frames) {
    const auto dn = FrameAverager(sensor(), frames).average(light, {7, 2, 1});
    double sum = 0, squares = 0;
    for (const float v : dn) {
      sum += static_cast<double>(v);
      squares += static_cast<double>(v) * static_cast<double>(v);
    }
    const double mean = sum / static_cast<double>(dn.size());
    return std::sqrt(squares / static_cast<double>(dn.size()) - mean * mean);
  };
  EXPECT_NEAR(scatter(1) / scatter(16), 4.0, 0.1);
}

TEST(BoardPoses, show_every_dot_tilted_all_over_the_depth) {
  const Instrument instrument(probe_rig(), {});
  const DotBoardConfig board;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const auto poses = board_poses(instrument, board, 12, seed);
    ASSERT_TRUE(poses) << poses.error().message();
    double nearest = 1e9, farthest = 0;
    for (const Pose& T_model_cam : *poses) {
      const Pose T_cam_model = T_model_cam.inverse();
      const Vec3d middle = T_cam_model.translation(), normal = T_cam_model.linear().col(2);
      nearest = std::min(nearest, middle.z());
      farthest = std::max(farthest, middle.z());
      const double tilt = std::acos(-normal.z()) * 180 / std::numbers::pi;
      EXPECT_GE(tilt, 15 - 1e-6);
      EXPECT_LE(tilt, 35 + 1e-6);
      for (int i = 0; i < board.cols * board.rows; ++i) {
        const Vec3d dot((i % board.cols - 0.5 * (board.cols - 1)) * board.pitch_mm,
                        (i / board.cols - 0.5 * (board.rows - 1)) * board.pitch_mm, 0);
        const Eigen::Vector2d px = project(instrument.rig.camera, T_cam_model * dot);
        EXPECT_TRUE(px.x() > 12 && px.x() < 627 && px.y() > 12 && px.y() < 467) << px.transpose();
      }
    }
    EXPECT_LT(nearest, 45.5);
    EXPECT_GT(farthest, 51.5);
  }
}

TEST(BoardPoses, a_board_that_does_not_fit_is_named) {
  DotBoardConfig board;
  board.pitch_mm = 4;
  const auto poses = board_poses(Instrument(probe_rig(), {}), board, 3, 1);
  ASSERT_FALSE(poses);
  EXPECT_EQ(poses.error().code, ErrorCode::kConfigValue);
  EXPECT_NE(poses.error().detail.find("board.pitch_mm"), std::string::npos);
}

TEST(StillRenderer, gives_the_light_that_the_scan_renderer_gives) {
  const Instrument instrument(small_rig(), {});
  PlaneConfig plane;
  plane.grid_mm = 2;
  const RayScene scene(make_plane(plane));
  const RenderConfig config;
  BurstPoses poses;
  poses.is_static = true;
  poses.mid.linear() = Eigen::AngleAxisd(std::numbers::pi - 0.4, Vec3d::UnitX()).toRotationMatrix();
  poses.mid.translation() = poses.mid.linear() * Vec3d(0, 0, -48);
  const auto scan = BurstRenderer(instrument, scene, config).render(poses);
  const StillRenderer still(instrument, scene, config);
  const auto shaded = StillRenderer::shade(still.trace(poses.mid), instrument.light);
  const std::size_t w = 160, h = 120;
  for (std::size_t k = 0; k < 4; ++k) {
    // The outermost pixels may see the edge of the lit field, where the still renderer samples finer.
    for (std::size_t y = 10; y < h - 10; ++y)
      for (std::size_t x = 10; x < w - 10; ++x) EXPECT_NEAR(scan[k][y * w + x], shaded[k][y * w + x], 1e-5F);
  }
}

TEST(DotPrint, is_sharp_and_where_it_was_printed) {
  DotBoardConfig config;
  config.dot_error_um = 3;
  const Surroundings board = make_dot_board(config, 9);
  double squares = 0;
  for (const auto& o : board.print->offsets_mm) squares += o.squaredNorm();
  EXPECT_NEAR(std::sqrt(squares / (2.0 * 63)), 0.003, 0.0006);
  const Eigen::Vector2d centre = Eigen::Vector2d(-6.4, -4.8) + board.print->offsets_mm[0];
  const auto albedo = [&](double dx) { return board.print->albedo({centre.x() + dx, centre.y(), 0}); };
  EXPECT_EQ(albedo(config.radius_mm - 1e-9), board.print->dot_albedo);
  EXPECT_EQ(albedo(config.radius_mm + 1e-9), board.print->ground_albedo);
}

TEST(NominalRig, is_off_the_truth_within_tolerances_and_says_so) {
  const calib::Rig truth = probe_rig();
  const MultiPatterns patterns(truth, {1, 4, 16, 64}, 127, 120);
  const auto text = nominal_rig_text(truth, patterns, 16, 3);
  ASSERT_TRUE(text);
  const auto rig = calib::parse_rig(*text);
  ASSERT_TRUE(rig) << rig.error().message();
  EXPECT_NE(text->find("\"nominal\": true"), std::string::npos);
  EXPECT_NE(text->find("\"averaged_frames\": 16"), std::string::npos);
  EXPECT_EQ(rig->patterns.mode, calib::PatternMode::kMulti);
  EXPECT_EQ(rig->serial, truth.serial);
  EXPECT_NE(rig->camera.fx, truth.camera.fx);
  EXPECT_NEAR(rig->camera.fx / truth.camera.fx, 1, 0.003 + 1e-12);
  EXPECT_NEAR(rig->camera.cx, truth.camera.cx, 3);
  EXPECT_NE(*text, *nominal_rig_text(truth, patterns, 16, 4));
}

TEST(BoardSource, shows_every_set_at_every_stand_in_order) {
  SceneConfig scene;
  scene.rig_path = std::string(ENAMEL_SOURCE_DIR) + "/config/rigs/probe.json";
  scene.object = ObjectKind::kBoard;
  scene.path = PathKind::kCalibration;
  scene.calibration.poses = 1;
  scene.calibration.sweeps = 1;
  scene.calibration.cycles = {1};
  const auto source = BoardSource::create(scene);
  ASSERT_TRUE(source) << source.error().message();
  EXPECT_EQ((*source)->count(), 3U);
  for (int set = 0; set < 3; ++set) {
    const auto burst = (*source)->next();
    ASSERT_TRUE(burst && *burst);
    EXPECT_EQ((*burst)->pattern_set, set);
    const auto mean = [&](std::size_t k) {
      double sum = 0;
      for (const std::uint8_t v : (*burst)->frames[k]) sum += v;
      return sum / static_cast<double>((*burst)->frames[k].size());
    };
    if (set == 0) {
      EXPECT_GT(mean(0), mean(1) + 10);
    } else {
      // Opposite steps of a fringe add up to the same light.
      EXPECT_NEAR(mean(0) + mean(2), mean(1) + mean(3), 1.0);
    }
  }
  const auto end = (*source)->next();
  ASSERT_TRUE(end);
  EXPECT_FALSE(end->has_value());
}

}  // namespace
}  // namespace enamel::twin::testing
