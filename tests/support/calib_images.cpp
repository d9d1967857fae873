#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "tests/support/calib_optics.hpp"
#include "tests/support/calib_scene.hpp"

namespace enamel::test {

using calib::LensValues;
using Eigen::Vector2d;

namespace {

constexpr double kTau = 2 * std::numbers::pi;

}  // namespace

calib::PixelNoise noise_of(const SensorModel& m) {
  const double read_dn = m.read_e / m.gain_e_per_dn;
  return {(read_dn * read_dn + 1.0 / 12) / m.averages + 1.0 / 12 + m.extra_noise_dn * m.extra_noise_dn,
          1 / m.gain_e_per_dn / m.averages};
}

namespace {

/// What does not change between the frames of a pose.
struct Still {
  Map<float> albedo;
  Map<float> light;  ///< of a full white, DN on albedo 1
  Map<double> u, v;  ///< projector coordinates
};

double albedo_at(const CalibScene& s, const Vec3d& on_target) {
  const double half_x = 0.5 * (s.target.cols - 1), half_y = 0.5 * (s.target.rows - 1);
  const int col =
      std::clamp(static_cast<int>(std::lround(on_target.x() / s.target.pitch_mm + half_x)), 0, s.target.cols - 1);
  const int row =
      std::clamp(static_cast<int>(std::lround(on_target.y() / s.target.pitch_mm + half_y)), 0, s.target.rows - 1);
  const Vec3d centre = place(s, s.target.index({col, row}));
  return (on_target - centre).head<2>().norm() < s.target.radius_mm ? 0.85 : 0.15;
}

Still still_of(const CalibScene& s, const Pose& T) {
  const LensValues& camera = s.truth.camera;
  Still still{Map<float>(camera.width, camera.height), Map<float>(camera.width, camera.height),
              Map<double>(camera.width, camera.height), Map<double>(camera.width, camera.height)};
  const Pose back = T.inverse();
  const Vec3d normal = T.linear().col(2);
  const Vec3d projector = s.truth.T_proj_cam.inverse().translation();
  const auto hit_of = [&](const Vector2d& px) {
    const Vec3d ray = ray_of(camera, px);
    return Vec3d(ray * (normal.dot(T.translation()) / normal.dot(ray)));
  };
  constexpr int kSide = 8;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Vec3d hit = hit_of(Vector2d(x, y));
      const Vec3d step_u = hit_of(Vector2d(x + 0.5, y)) - hit, step_v = hit_of(Vector2d(x, y + 0.5)) - hit;
      double albedo = 0;
      for (int b = 0; b < kSide; ++b)
        for (int a = 0; a < kSide; ++a)
          albedo +=
              albedo_at(s, back * (hit + ((2 * a + 1.0) / kSide - 1) * step_u + ((2 * b + 1.0) / kSide - 1) * step_v));
      still.albedo(x, y) = static_cast<float>(albedo / (kSide * kSide));
      const Vec3d way = projector - hit;
      still.light(x, y) = static_cast<float>(250 * (44.0 * 44.0 / way.squaredNorm()) * normal.dot(way.normalized()));
      const Vector2d q = projector_pixel(s, hit);
      still.u(x, y) = q.x();
      still.v(x, y) = q.y();
    }
  }
  return still;
}

/// Emission of a projector level 0…1: linear but for a bow.
double emission(double x, double bow) { return 0.002 + 0.998 * (x + bow * 4 * x * (1 - x) * (1 + 0.5 * (x - 0.5))); }

template <class Level>
Map<float> expose(const Still& still, const SensorModel& m, Rng& rng, const Level& level) {
  cv::Mat light(still.albedo.height(), still.albedo.width(), CV_32F);
  for (int y = 0; y < light.rows; ++y)
    for (int x = 0; x < light.cols; ++x)
      light.at<float>(y, x) = still.albedo(x, y) * still.light(x, y) *
                              static_cast<float>(emission(level(still.u(x, y), still.v(x, y)), m.gamma_bow));
  cv::GaussianBlur(light, light, {0, 0}, m.blur_px, m.blur_px, cv::BORDER_REFLECT);
  Map<float> out(light.cols, light.rows);
  const calib::PixelNoise noise{(m.read_e * m.read_e / m.gain_e_per_dn / m.gain_e_per_dn + 1.0 / 12) / m.averages +
                                    m.extra_noise_dn * m.extra_noise_dn,
                                1 / m.gain_e_per_dn / m.averages};
  for (int y = 0; y < light.rows; ++y) {
    for (int x = 0; x < light.cols; ++x) {
      const double signal = static_cast<double>(light.at<float>(y, x));
      const double dn = m.black_dn + signal + std::sqrt(noise.variance(signal)) * rng.normal();
      out(x, y) = static_cast<float>(std::clamp(std::round(dn), 0.0, 255.0));
    }
  }
  return out;
}

}  // namespace

calib::PoseFrames render_pose(const CalibScene& s, std::size_t pose, const SensorModel& m, Rng& rng) {
  const Still still = still_of(s, s.truth.T_cam_target[pose]);
  calib::PoseFrames frames;
  frames.name = std::to_string(pose);
  frames.white = expose(still, m, rng, [](double, double) { return 1.0; });
  frames.black = expose(still, m, rng, [](double, double) { return 0.0; });
  for (const int cycles : {1, 4, 16, 64}) {
    for (const bool is_v : {false, true}) {
      calib::FringeLevel level{.cycles = cycles, .frames = {}};
      const double side = is_v ? s.truth.projector.height : s.truth.projector.width;
      for (int k = 0; k < 4; ++k)
        level.frames[static_cast<std::size_t>(k)] = expose(still, m, rng, [&](double u, double v) {
          return (127 + 120 * std::cos(kTau * ((is_v ? v : u) * cycles / side + 0.25 * k))) / 255;
        });
      (is_v ? frames.along_v : frames.along_u).push_back(std::move(level));
    }
  }
  return frames;
}

}  // namespace enamel::test
