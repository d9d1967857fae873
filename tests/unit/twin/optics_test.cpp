// Lenses, projector table, sensor.
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "tests/unit/twin/twin_fixture.hpp"
#include "tools/twin/optics/lens.hpp"
#include "tools/twin/optics/projector.hpp"
#include "tools/twin/optics/sensor.hpp"

namespace enamel::twin {
namespace {

using testing::kPi;

using testing::probe_rig;

TEST(TwinLens, projects_like_open_cv) {
  const auto rig = probe_rig();
  for (const auto& l : {rig.camera, rig.projector}) {
    const Lens lens(l);
    const cv::Matx33d K(l.fx, 0, l.cx, 0, l.fy, l.cy, 0, 0, 1);
    const std::vector<double> dist(l.dist.begin(), l.dist.end());
    std::vector<cv::Point3d> points;
    points.reserve(200);
    for (int i = 0; i < 200; ++i) points.emplace_back(-9 + 0.09 * i, 6.5 * std::sin(0.7 * i), 40 + 0.08 * i);
    std::vector<cv::Point2d> expected;
    cv::projectPoints(points, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), K, dist, expected);
    for (std::size_t i = 0; i < points.size(); ++i) {
      double u = 0, v = 0;
      ASSERT_TRUE(lens.project(points[i].x, points[i].y, points[i].z, u, v));
      EXPECT_NEAR(u, expected[i].x, 1e-9);
      EXPECT_NEAR(v, expected[i].y, 1e-9);
    }
  }
}

TEST(TwinLens, direction_inverts_projection) {
  const Lens lens(probe_rig().camera);
  for (double u = -0.5; u <= 639.5; u += 40) {
    for (double v = -0.5; v <= 479.5; v += 40) {
      const Eigen::Vector2d d = lens.direction(u, v);
      double pu = 0, pv = 0;
      ASSERT_TRUE(lens.project(48 * d.x(), 48 * d.y(), 48, pu, pv));
      EXPECT_NEAR(pu, u, 1e-9);
      EXPECT_NEAR(pv, v, 1e-9);
    }
  }
}

TEST(TwinLens, refuses_points_behind_and_far_outside) {
  const Lens lens(probe_rig().camera);
  double u = 0, v = 0;
  EXPECT_FALSE(lens.project(0, 0, -48, u, v));
  EXPECT_FALSE(lens.project(480, 0, 48, u, v));
}

/// RMS phase error of four steps read from the projector's table, over one period far from the borders.
double four_step_error(double gamma, double* peak = nullptr) {
  calib::Rig rig = probe_rig();
  rig.patterns.mode = calib::PatternMode::kPlain4;
  rig.patterns.period_px = 240;
  rig.patterns.mean = rig.patterns.amplitude = 127.5;
  ProjectorConfig config;
  config.round_levels = false;
  config.gamma = gamma;
  config.lut_gamma = 1;
  config.black_fraction = 0;
  config.blur_sigma_px = 1.0;  // smooths the pixels' staircase, leaves the period of 240
  config.defocus_px_per_mm = 0;
  const ProjectorLight light(calib::pattern_levels(rig), config, 40, 56);
  double sum = 0, worst = 0;
  constexpr int kPoints = 4800;
  for (int i = 0; i < kPoints; ++i) {
    const double u = 240 + 240.0 * i / kPoints;
    const auto tap = light.tap(u, light.sigma2_at(48));
    std::array<double, 4> I{};
    for (int k = 0; k < 4; ++k) I[static_cast<std::size_t>(k)] = static_cast<double>(light.emission(k, tap));
    const double e = testing::wrap(std::atan2(I[3] - I[1], I[0] - I[2]) - 2 * kPi * u / 240);
    sum += e * e;
    worst = std::max(worst, std::abs(e));
  }
  if (peak != nullptr) *peak = worst;
  return std::sqrt(sum / kPoints);
}

TEST(TwinProjector, gamma_error_follows_the_table_of_four_steps) {
  EXPECT_NEAR(four_step_error(1.5), 0.0101, 0.0003);
  EXPECT_NEAR(four_step_error(2.2), 0.0075, 0.0003);
  EXPECT_NEAR(four_step_error(2.8), 0.0364, 0.0008);
  EXPECT_LT(four_step_error(1.0), 3e-5);  // control: linear projector, no error
}

TEST(TwinProjector, blur_attenuates_a_fringe_by_its_transfer_function) {
  calib::Rig rig = probe_rig();
  rig.patterns.mode = calib::PatternMode::kPlain4;
  ProjectorConfig config;
  config.round_levels = false;
  config.gamma = config.lut_gamma = 1;
  const ProjectorLight light(calib::pattern_levels(rig), config, 40, 56);
  for (const double z : {42.0, 49.0, 55.0}) {
    double c = 0, s = 0;
    constexpr int kPoints = 960;
    for (int i = 0; i < kPoints; ++i) {
      const double u = 240 + 24.0 * i / kPoints, phi = 2 * kPi * u / 24;
      const double e = static_cast<double>(light.emission(0, light.tap(u, light.sigma2_at(z))));
      c += e * std::cos(phi) * 2 / kPoints;
      s += e * std::sin(phi) * 2 / kPoints;
    }
    const double f = 1.0 / 24, pixel = std::sin(kPi * f) / (kPi * f);
    const double expected = 0.998 * 120 / 255 * pixel * std::exp(-2 * kPi * kPi * f * f * light.sigma2_at(z));
    EXPECT_NEAR(c, expected, 2e-5) << z;
    EXPECT_NEAR(s, 0, 2e-5) << z;
  }
}

TEST(TwinProjector, polarity_turns_only_the_fourth_frame) {
  const auto p = probe_rig().patterns;
  calib::PatternValues plain = p;
  plain.mode = calib::PatternMode::kPlain4;
  for (int i = 0; i < 854; ++i) {
    for (int k = 0; k < 3; ++k) EXPECT_EQ(calib::pattern_level(p, k, i), calib::pattern_level(plain, k, i));
    const int cell = i / 12 + p.first_cell;
    const double b = p.polarity_code[static_cast<std::size_t>(cell) % p.polarity_code.size()];
    EXPECT_NEAR(calib::pattern_level(p, 3, i) - p.mean, b * (calib::pattern_level(plain, 3, i) - p.mean), 1e-9) << i;
  }
}

/// Levels worked out by hand from docs/recording-format.md: period 24, ratio 6, so that the code's period is 144/7 px.
TEST(TwinProjector, mode_m_is_three_steps_around_a_code_frame) {
  calib::PatternValues p;
  p.mode = calib::PatternMode::kMicro;
  p.period_px = 24;
  p.code_ratio = 6;
  p.mean = 127.5, p.amplitude = 120;
  EXPECT_NEAR(calib::pattern_level(p, 0, 0), 247.5, 1e-9);
  EXPECT_NEAR(calib::pattern_level(p, 1, 0), 247.5, 1e-9);
  EXPECT_NEAR(calib::pattern_level(p, 2, 0), 67.5, 1e-9);  // cos 120 degrees
  EXPECT_NEAR(calib::pattern_level(p, 3, 0), 67.5, 1e-9);
  EXPECT_NEAR(calib::pattern_level(p, 2, 16), 247.5, 1e-9);  // frame 2 peaks a third of a period before pixel 24
  EXPECT_NEAR(calib::pattern_level(p, 3, 8), 247.5, 1e-9);   // frame 3 two thirds
  EXPECT_NEAR(calib::pattern_level(p, 1, 72), 7.5, 1e-9);    // 3.5 periods of the code
  EXPECT_NEAR(calib::pattern_level(p, 1, 144), 247.5, 1e-9);
}

struct Moments {
  double mean, variance;
};

Moments exposed(double electrons, const SensorConfig& config) {
  const std::vector<float> light(400000, static_cast<float>(electrons));
  const auto bytes = digitise(light, config, {7, 3, 1});
  double sum = 0, sum2 = 0;
  for (std::size_t i = 0; i < light.size(); ++i) {
    const double v = bytes[2 * i] + 256.0 * bytes[2 * i + 1];
    sum += v;
    sum2 += v * v;
  }
  const double n = static_cast<double>(light.size()), mean = sum / n;
  return {mean, sum2 / n - mean * mean};
}

TEST(TwinSensor, photon_transfer_has_unit_slope_and_read_noise_as_intercept) {
  SensorConfig config;
  config.bits = 16;
  config.gain_e_per_dn = 1;
  config.black_dn = 200;
  const Moments dark = exposed(0, config);
  const double intercept = 25 + 1.0 / 12;
  EXPECT_NEAR(dark.mean, 200, 0.05);
  EXPECT_NEAR(dark.variance, intercept, 0.01 * intercept);
  double slope = 0;
  const std::vector<double> levels{8, 30, 200, 1500, 5000, 8000};
  for (const double e : levels) {
    const Moments m = exposed(e, config);
    EXPECT_NEAR(m.mean, 200 + e, 4 * std::sqrt(m.variance / 400000) + 0.02) << e;
    slope += (m.variance - dark.variance) / (m.mean - dark.mean) / static_cast<double>(levels.size());
  }
  EXPECT_NEAR(slope, 1.0, 0.01);
  config.shot_noise = false;  // control: the slope vanishes
  EXPECT_NEAR(exposed(5000, config).variance, intercept, 0.02 * intercept);
  config.read_noise = false;
  EXPECT_LT(exposed(5000, config).variance, 1e-9);
}

TEST(TwinSensor, full_well_and_converter_clip) {
  SensorConfig config;
  const auto bright = digitise(std::vector<float>(1000, 20000.0F), config, {1, 0, 0});
  for (const auto v : bright) EXPECT_GE(v, 254);
  config.shot_noise = config.read_noise = false;
  const auto exact = digitise({0.0F, 3984.0F, 1e6F}, config, {1, 0, 0});
  EXPECT_EQ(exact[0], 4);
  EXPECT_EQ(exact[1], 104);
  EXPECT_EQ(exact[2], 255);
}

TEST(TwinSensor, noise_is_a_function_of_seed_burst_frame_and_pixel) {
  const std::vector<float> light(5000, 4000.0F);
  const SensorConfig config;
  const auto a = digitise(light, config, {1, 2, 3});
  EXPECT_EQ(a, digitise(light, config, {1, 2, 3}));
  EXPECT_NE(a, digitise(light, config, {2, 2, 3}));
  EXPECT_NE(a, digitise(light, config, {1, 3, 3}));
  EXPECT_NE(a, digitise(light, config, {1, 2, 0}));
}

}  // namespace
}  // namespace enamel::twin
