#include "tests/support/calib_scene.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "calib/solve/disc_bias.hpp"
#include "calib/solve/ground.hpp"

namespace enamel::test {
namespace {

using calib::LensValues;
using Eigen::Vector2d;

constexpr double kTau = 2 * std::numbers::pi;

/// OpenCV's formula, written out.
Vector2d pixel_of(const LensValues& l, const Vec3d& p) {
  const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
  const double g = 1 + l.dist[0] * r2 + l.dist[1] * r2 * r2 + l.dist[4] * r2 * r2 * r2;
  return {l.fx * (x * g + 2 * l.dist[2] * x * y + l.dist[3] * (r2 + 2 * x * x)) + l.cx,
          l.fy * (y * g + l.dist[2] * (r2 + 2 * y * y) + 2 * l.dist[3] * x * y) + l.cy};
}

/// Fixed-point inversion of the formula above.
Vec3d ray_of(const LensValues& l, const Vector2d& px) {
  const Vector2d goal((px.x() - l.cx) / l.fx, (px.y() - l.cy) / l.fy);
  Vector2d p = goal;
  for (int i = 0; i < 30; ++i) {
    const Vector2d q = pixel_of(l, {p.x(), p.y(), 1});
    const Vector2d d((q.x() - px.x()) / l.fx, (q.y() - px.y()) / l.fy);
    p -= d;
    if (d.norm() < 1e-14) break;
  }
  return {p.x(), p.y(), 1};
}

LensValues scattered(LensValues l, Rng& rng) {
  const double f = rng.uniform(0.98, 1.02);
  l.fx *= f * rng.uniform(0.9995, 1.0005);
  l.fy *= f * rng.uniform(0.9995, 1.0005);
  l.cx += rng.uniform(-4, 4);
  l.cy += rng.uniform(-4, 4);
  l.dist = {rng.uniform(-0.08, 0.03), rng.uniform(-0.02, 0.02), rng.uniform(-4e-4, 4e-4), rng.uniform(-4e-4, 4e-4), 0};
  return l;
}

Pose turned(double rx, double ry, double rz) {
  Pose p = Pose::Identity();
  p.linear() = (Eigen::AngleAxisd(rz, Vec3d::UnitZ()) * Eigen::AngleAxisd(ry, Vec3d::UnitY()) *
                Eigen::AngleAxisd(rx, Vec3d::UnitX()))
                   .toRotationMatrix();
  return p;
}

Vec3d place(const CalibScene& s, int dot) {
  return s.target.place(dot) + s.truth.dot_offsets_mm[static_cast<std::size_t>(dot)];
}

/// Where the scene's projector lights a point in camera coordinates from.
Vector2d projector_pixel(const CalibScene& s, const Vec3d& p) {
  const double x = p.x() / 8;
  const Vec3d bowed = p * (1 + 1e-3 * s.bow_um * x * x / p.z());
  Vector2d q = pixel_of(s.truth.projector, s.truth.T_proj_cam * bowed);
  if (s.wave_px > 0)
    q.x() += s.wave_px * std::sin(kTau * (1.2 * q.x() / s.truth.projector.width + 0.1)) *
             std::cos(kTau * (0.7 * q.y() / s.truth.projector.height + 0.2));
  return q;
}

/// Whether every dot lies inside both frames with room to spare.
bool is_in_view(const CalibScene& s, const Pose& T_cam_target) {
  constexpr double kRoom_px = 32;
  for (int i = 0; i < s.target.size(); ++i) {
    const Vec3d p = T_cam_target * s.target.place(i);
    const Vector2d c = pixel_of(s.truth.camera, p), q = pixel_of(s.truth.projector, s.truth.T_proj_cam * p);
    for (const auto& [at, lens] : {std::pair{c, &s.truth.camera}, std::pair{q, &s.truth.projector}})
      if (at.x() < kRoom_px || at.y() < kRoom_px || at.x() > lens->width - kRoom_px || at.y() > lens->height - kRoom_px)
        return false;
  }
  return true;
}

}  // namespace

CalibScene make_calib_scene(std::uint64_t seed, int poses) {
  Rng rng(seed, 0, 1);
  CalibScene s;
  s.target = {
      .type = calib::TargetType::kCircleGrid, .cols = 9, .rows = 7, .pitch_mm = 1.8, .radius_mm = 0.33, .marks = {}};
  s.nominal.camera = {640, 480, 1707, 1707, 319.5, 239.5, {}};
  s.nominal.projector = {854, 480, 1605, 1605, 426.5, 239.5, {}};
  s.nominal.depth_range = calib::DepthRange{40, 56};
  const Pose design = Eigen::Translation3d(-9.977, 0, 2.120) * turned(0, 0.20937, 0);
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c)
      s.nominal.T_proj_cam[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] = design.matrix()(r, c);
  s.truth.camera = scattered(s.nominal.camera, rng);
  s.truth.projector = scattered(s.nominal.projector, rng);
  s.truth.T_proj_cam = design * turned(rng.uniform(-.004, .004), rng.uniform(-.004, .004), rng.uniform(-.004, .004));
  s.truth.T_proj_cam.translation() += Vec3d(rng.uniform(-.3, .3), rng.uniform(-.2, .2), rng.uniform(-.3, .3));
  s.truth.dot_offsets_mm.assign(static_cast<std::size_t>(s.target.size()), Vec3d::Zero());
  // z of the target towards the camera: half a turn about x, then the tilt.
  while (static_cast<int>(s.truth.T_cam_target.size()) < poses) {
    const double tilt = rng.uniform(0, 35) * std::numbers::pi / 180, way = rng.uniform(0, kTau);
    Pose p = turned(std::numbers::pi, 0, 0);
    p = turned(tilt * std::cos(way), tilt * std::sin(way), rng.uniform(-0.5, 0.5)) * p;
    p.translation() = Vec3d(rng.uniform(-2, 2), rng.uniform(-1.5, 1.5), rng.uniform(44, 55));
    if (is_in_view(s, p)) s.truth.T_cam_target.push_back(p);
  }
  return s;
}

void deform_target(CalibScene& s, double in_plane_mm, double bow_mm, Rng& rng) {
  const double way = rng.uniform(0, kTau);
  const double half = 0.5 * s.target.pitch_mm * (s.target.cols - 1);
  for (int i = 0; i < s.target.size(); ++i) {
    const Vec3d p = s.target.place(i);
    const double along = (std::cos(way) * p.x() + std::sin(way) * p.y()) / half;
    s.truth.dot_offsets_mm[static_cast<std::size_t>(i)] = {in_plane_mm * rng.normal(), in_plane_mm * rng.normal(),
                                                           bow_mm * along * along};
  }
}

namespace {

/// Every tenth camera pixel that lies on the ground, half a millimetre off the dots' edges, between dots that bend the
/// board.
std::vector<calib::GroundSample> make_ground(const CalibScene& s, const Pose& T, double noise_px, Rng& rng) {
  std::vector<calib::GroundSample> ground;
  const Vec3d normal = T.linear().col(2);
  const Pose back = T.inverse();
  for (int v = 5; v < s.truth.camera.height; v += 10) {
    for (int u = 5; u < s.truth.camera.width; u += 10) {
      const Vec3d ray = ray_of(s.truth.camera, Vector2d(u, v));
      const Vec3d hit = ray * (normal.dot(T.translation()) / normal.dot(ray));
      const Vector2d cell =
          (back * hit).head<2>() / s.target.pitch_mm + 0.5 * Vector2d(s.target.cols - 1, s.target.rows - 1);
      const Vector2d nearest(std::round(cell.x()), std::round(cell.y()));
      const bool inside = cell.minCoeff() > 0 && cell.x() < s.target.cols - 1 && cell.y() < s.target.rows - 1;
      if (!inside || (cell - nearest).norm() * s.target.pitch_mm < s.target.radius_mm + 0.5) continue;
      const double height_mm = calib::board_height_mm(s.target, cell, s.truth.dot_offsets_mm);
      const Vec3d on_board = ray * ((normal.dot(T.translation()) + height_mm) / normal.dot(ray));
      calib::GroundSample sample;
      sample.camera_px = Vector2d(u, v);
      sample.projector_u_px = projector_pixel(s, on_board).x() + noise_px * rng.normal();
      sample.variance_px2 = noise_px * noise_px;
      sample.cell = cell;
      ground.push_back(sample);
    }
  }
  return ground;
}

}  // namespace

std::vector<calib::PoseView> make_views(const CalibScene& s, const ViewNoise& noise, Rng& rng) {
  std::vector<calib::PoseView> views;
  for (std::size_t j = 0; j < s.truth.T_cam_target.size(); ++j) {
    calib::PoseView view{.name = std::to_string(j), .dots = {}, .ground = {}, .blur_px = 0.6};
    const Pose& T = s.truth.T_cam_target[j];
    for (int i = 0; i < s.target.size(); ++i) {
      const Vec3d p = T * place(s, i);
      const Vec3d normal = T.linear().col(2);
      const Vector2d centre = pixel_of(s.truth.camera, p);
      calib::DotView dot;
      dot.dot = i;
      dot.ellipse.centre = centre + calib::disc_bias(s.truth.camera, T, place(s, i), s.target.radius_mm) +
                           noise.centre_px * Vector2d(rng.normal(), rng.normal());
      dot.ellipse.shape = Eigen::Matrix2d::Identity() / 144;
      dot.covariance_px2 = Eigen::Matrix2d::Identity() * noise.centre_px * noise.centre_px;
      dot.camera_px = dot.ellipse.centre;
      for (int v = -5; v <= 5; ++v) {
        for (int u = -5; u <= 5; ++u) {
          const Vector2d at(std::round(centre.x()) + 1.6 * u, std::round(centre.y()) + 1.6 * v);
          const Vec3d ray = ray_of(s.truth.camera, at);
          const Vec3d hit = ray * (normal.dot(p) / normal.dot(ray));
          const Vector2d q = projector_pixel(s, hit) + noise.projector_px * Vector2d(rng.normal(), rng.normal());
          dot.samples.push_back({at, q, Vector2d::Constant(noise.projector_px * noise.projector_px)});
        }
      }
      if (const auto map = calib::fit_local_map(dot.samples, dot.camera_px)) dot.map = *map;
      view.dots.push_back(std::move(dot));
    }
    if (noise.ground_px > 0) view.ground = make_ground(s, T, noise.ground_px, rng);
    views.push_back(std::move(view));
  }
  return views;
}

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

Vec3d measured_place(const calib::RigState& solved, const CalibScene& scene, const Vec3d& point) {
  const double up = projector_pixel(scene, point).x();
  const Vector2d pixel = pixel_of(scene.truth.camera, point);
  const Vec3d ray = ray_of(solved.camera, pixel);
  const auto at = [&](double d) { return pixel_of(solved.projector, solved.T_proj_cam * Vec3d(ray * d)).x(); };
  double depth = point.z();
  for (int i = 0; i < 20; ++i) depth += (up - at(depth)) / ((at(depth + 1e-4) - at(depth - 1e-4)) / 2e-4);
  if (solved.correction)
    depth = 1 / (1 / depth + calib::correction_at(*solved.correction, pixel.x(), pixel.y(), 1 / depth));
  return ray * depth;
}

namespace {

/// Bow of a facing plane along x and y, the larger one, over 16 mm.
double sag_um(const calib::RigState& solved, const CalibScene& scene, double z) {
  Eigen::Matrix<double, 6, 6> h = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
  for (double y = -5; y <= 5; y += 1)
    for (double x = -7; x <= 7; x += 1) {
      const Vec3d p = measured_place(solved, scene, {x, y, z});
      const Eigen::Matrix<double, 6, 1> j =
          (Eigen::Matrix<double, 6, 1>() << 1, x / 8, y / 8, x * x / 64, x * y / 64, y * y / 64).finished();
      h += j * j.transpose();
      b += j * 1e3 * (p.z() - z);
    }
  const Eigen::Matrix<double, 6, 1> c = h.inverse() * b;
  return std::max(std::abs(c[3]), std::abs(c[5]));
}

}  // namespace

RigError rig_error(const calib::RigState& solved, const calib::RigState& truth) {
  CalibScene scene;
  scene.truth = truth;
  return rig_error(solved, scene);
}

RigError rig_error(const calib::RigState& solved, const CalibScene& scene) {
  std::vector<Vec3d> from, to;
  for (double z = 40; z <= 56; z += 2) {
    for (double v = 0; v <= 479; v += 479.0 / 12) {
      for (double u = 0; u <= 639; u += 639.0 / 16) {
        const Vec3d q = z * ray_of(scene.truth.camera, {u, v});
        const double up = projector_pixel(scene, q).x();
        if (up < -0.5 || up > scene.truth.projector.width - 0.5) continue;
        from.push_back(measured_place(solved, scene, q));
        to.push_back(q);
      }
    }
  }
  Vec3d mean_from = Vec3d::Zero(), mean_to = Vec3d::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    mean_from += from[i];
    mean_to += to[i];
  }
  mean_from /= static_cast<double>(from.size());
  mean_to /= static_cast<double>(from.size());
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
  double spread = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    cross += (from[i] - mean_from) * (to[i] - mean_to).transpose();
    spread += (from[i] - mean_from).squaredNorm();
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d r = svd.matrixV() * svd.matrixU().transpose();
  const double scale = svd.singularValues().sum() / spread;
  std::vector<double> off, scaled;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Vec3d turned_point = r * (from[i] - mean_from), goal = to[i] - mean_to;
    off.push_back(1e3 * (turned_point - goal).norm());
    scaled.push_back(1e3 * (scale * turned_point - goal).norm());
  }
  std::sort(off.begin(), off.end());
  std::sort(scaled.begin(), scaled.end());
  RigError error{off[off.size() * 95 / 100], off.back(), 1e6 * (scale - 1), scaled[scaled.size() * 95 / 100]};
  for (const double z : {42.0, 48.0, 54.0}) error.sag_um = std::max(error.sag_um, sag_um(solved, scene, z));
  return error;
}

}  // namespace enamel::test
