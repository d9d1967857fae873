#include "tests/support/calib_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calib/solve/disc_bias.hpp"
#include "calib/solve/ground.hpp"
#include "tests/support/calib_optics.hpp"

namespace enamel::test {
namespace {

using calib::LensValues;
using Eigen::Vector2d;

constexpr double kTau = 2 * std::numbers::pi;

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

}  // namespace enamel::test
