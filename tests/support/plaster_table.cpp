#include "tests/support/plaster_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <optional>

#include "calib/model/lens.hpp"
#include "tools/twin/jaw/jaw.hpp"
#include "tools/twin/mount/mount.hpp"
#include "tools/twin/optics/random.hpp"
#include "tools/twin/scene/scene.hpp"
#include "tools/twin/surface/ray_scene.hpp"

namespace enamel::test {
namespace {

constexpr double kLeastCos = 0.26;  // of a measurement: 75 degrees, to camera and to light
constexpr double kSigma_mm = 0.0085;
constexpr int kCoarser = 4;
constexpr double kEdge_mm = 0.35;
constexpr double kSlid_mm = 2, kTurned_deg = 10;  // of the model by who sets it on the table

template <class T>
T need(Result<T> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "%s\n", result.error().message().c_str());
  std::exit(exit_code(result.error().code));
}

void coarsen(calib::LensValues& lens) {
  lens.width /= kCoarser, lens.height /= kCoarser;
  lens.fx /= kCoarser, lens.fy /= kCoarser;
  lens.cx = (lens.cx + 0.5) / kCoarser - 0.5, lens.cy = (lens.cy + 0.5) / kCoarser - 0.5;
}

calib::AxisLine line_of(const twin::Axis& axis) {
  calib::AxisLine out;
  for (int k = 0; k < 3; ++k) {
    out.direction[static_cast<std::size_t>(k)] = axis.direction[k];
    out.point_mm[static_cast<std::size_t>(k)] = axis.point_mm[k];
  }
  out.harmonic_rad = axis.harmonic_rad;
  return out;
}

void set_ray(twin::RayPacket& rays, const Vec3d& from, const Vec3d& along, float near, float far) {
  const Vec3f o = from.cast<float>(), d = along.cast<float>();
  rays.ox[0] = o.x(), rays.oy[0] = o.y(), rays.oz[0] = o.z();
  rays.dx[0] = d.x(), rays.dy[0] = d.y(), rays.dz[0] = d.z();
  rays.near[0] = near, rays.far[0] = far;
  rays.active[0] = -1;
}

bool in_picture(const calib::LensValues& lens, const Vec3d& p) {
  if (p.z() < 1 || std::abs(p.x()) > p.z() || std::abs(p.y()) > p.z()) return false;
  const calib::PlanePoint px = calib::project(lens, {p.x() / p.z(), p.y() / p.z()});
  return px.x > -0.5 && px.y > -0.5 && px.x < lens.width - 0.5 && px.y < lens.height - 0.5;
}

}  // namespace

double ShownSurface::shown_mm2() const {
  double sum = 0;
  for (std::size_t n = 0; n < shown.size(); ++n) sum += shown[n] != 0 ? static_cast<double>(area_mm2[n]) : 0.0;
  return sum;
}

calib::AxisAngles stop_at(double rot_deg, double swing_deg) {
  calib::AxisAngles out;
  out.rotation_command = rot_deg * calib::kRadPerDegree;
  out.swing_command = swing_deg * calib::kRadPerDegree;
  return out;
}

ShownSurface shown_by(const PlasterTable& table, const std::vector<calib::AxisAngles>& stops,
                      double max_incidence_deg) {
  ShownSurface shown = table.surface();
  for (const calib::AxisAngles& stop : stops) table.show(stop, max_incidence_deg, shown);
  return shown;
}

double share_of(const ShownSurface& shown, const ShownSurface& goal) {
  ShownSurface both = goal;
  for (std::size_t n = 0; n < both.shown.size(); ++n) {
    if (shown.shown[n] == 0) both.shown[n] = 0;
  }
  return both.shown_mm2() / goal.shown_mm2();
}

std::vector<calib::AxisAngles> stops_all_round(double rot_step_deg, const std::vector<double>& swings_deg) {
  std::vector<calib::AxisAngles> out;
  for (double rot = 0; rot < 359.9; rot += rot_step_deg) {
    for (const double swing : swings_deg) out.push_back(stop_at(rot, swing));
  }
  return out;
}

struct PlasterTable::Parts {
  calib::Rig rig;
  calib::Mount mount;
  twin::Mount truth;
  twin::RayScene jaw;
  std::vector<SurfaceSample> samples;
  std::vector<float> area_mm2;
  Eigen::Isometry3d T_proj_cam;
  Vec3d projector_mm;  ///< camera frame

  [[nodiscard]] Pose T_model_camera(const calib::AxisAngles& angles) const {
    return twin::T_model_camera(truth, twin::table_at(truth, {angles.rotation(), angles.swing()}));
  }
  [[nodiscard]] bool is_free(const Vec3d& from, const Vec3d& to, const Vec3d& normal) const;
  [[nodiscard]] bool shows(const Pose& T_model_camera, const SurfaceSample& s, double least_cos) const;
};

bool PlasterTable::Parts::is_free(const Vec3d& from, const Vec3d& to, const Vec3d& normal) const {
  constexpr double kOff_mm = 0.01;
  twin::RayPacket packet;
  set_ray(packet, from + kOff_mm * normal, to - from, 1e-6F, 1);
  std::array<bool, twin::kPacket> blocked{};
  jaw.occluded(packet, blocked);
  return !blocked[0];
}

bool PlasterTable::Parts::shows(const Pose& T_model_camera, const SurfaceSample& s, double least_cos) const {
  const Vec3d p = T_model_camera.inverse() * s.point;
  if (p.z() < rig.depth_range->near_mm || p.z() > rig.depth_range->far_mm || !in_picture(rig.camera, p)) return false;
  if (!in_picture(rig.projector, T_proj_cam * p)) return false;
  const Vec3d eye = T_model_camera.translation(), light = T_model_camera * projector_mm;
  if (s.normal.dot((eye - s.point).normalized()) < least_cos) return false;
  if (s.normal.dot((light - s.point).normalized()) < least_cos) return false;
  return is_free(s.point, eye, s.normal) && is_free(s.point, light, s.normal);
}

PlasterTable::PlasterTable(Plaster kind, std::uint64_t seed) {
  const std::string root = ENAMEL_SOURCE_DIR;
  twin::SceneConfig scene = need(twin::load_scene(root + "/config/scenes/desktop_arch.toml"));
  calib::Rig rig = need(calib::load_rig(root + "/config/rigs/probe.json"));
  const twin::CounterRandom random(seed, 93);
  scene.mount.place_mm[0] += random.uniform(0, -kSlid_mm, kSlid_mm);
  scene.mount.place_mm[1] += random.uniform(1, -kSlid_mm, kSlid_mm);
  scene.mount.place_turn_deg += random.uniform(2, -kTurned_deg, kTurned_deg);
  scene.mount.stops = {{0, 0}};
  const twin::MountRun run = twin::drive(scene.mount, seed);
  twin::JawConfig config = scene.jaw;
  config.both_sides = kind == Plaster::kArch;
  config.max_edge_mm = kEdge_mm;
  twin::Surroundings surroundings;
  surroundings.mesh = twin::make_jaw(config, seed).mesh;
  surroundings.mesh.material.clear();
  surroundings.materials = twin::default_materials();
  Eigen::Isometry3d T_proj_cam = Eigen::Isometry3d::Identity();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) {
      T_proj_cam.matrix()(r, c) = rig.T_proj_cam[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
    }
  }
  coarsen(rig.camera);
  calib::Mount mount;
  mount.rotation = line_of(run.mount.rotation);
  mount.swing = line_of(run.mount.swing);
  std::vector<SurfaceSample> samples;
  std::vector<float> areas;
  for (const auto& t : surroundings.mesh.triangles) {
    const Vec3d a = surroundings.mesh.vertices[t[0]].cast<double>(),
                b = surroundings.mesh.vertices[t[1]].cast<double>(),
                c = surroundings.mesh.vertices[t[2]].cast<double>();
    const Vec3d across = (b - a).cross(c - a);
    if (across.norm() < 1e-9) continue;
    samples.push_back({(a + b + c) / 3, across.normalized()});
    areas.push_back(static_cast<float>(0.5 * across.norm()));
  }
  const Vec3d projector = T_proj_cam.inverse().translation();
  parts_.reset(new Parts{std::move(rig), mount, run.mount, twin::RayScene(std::move(surroundings)), std::move(samples),
                         std::move(areas), T_proj_cam, projector});
}

PlasterTable::~PlasterTable() = default;

const calib::Rig& PlasterTable::rig() const { return parts_->rig; }
const calib::Mount& PlasterTable::mount() const { return parts_->mount; }

SurfacePatch PlasterTable::see(const calib::AxisAngles& angles) const {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const Parts& w = *parts_;
  const Pose T = w.T_model_camera(angles);
  const int width = w.rig.camera.width, height = w.rig.camera.height;
  SurfacePatch out;
  out.depth_mm = out.sigma_mm = Map<float>(width, height, kNan);
  out.points = out.normals = Map<Vec3f>(width, height, Vec3f::Constant(kNan));
  const calib::RayTable rays = calib::make_ray_table(w.rig.camera);
  const Vec3d eye = T.translation(), light = T * w.projector_mm;
  for (std::size_t i = 0; i < out.depth_mm.size(); ++i) {
    const Vec3d ray(static_cast<double>(rays.x[i]), static_cast<double>(rays.y[i]), 1), along = T.linear() * ray;
    twin::RayPacket packet;
    set_ray(packet, eye, along, 5, 250);
    twin::HitPacket hits;
    w.jaw.intersect(packet, hits);
    twin::RayScene::Surfel s;
    if (hits.kind[0] == twin::HitKind::kNone || !w.jaw.resolve(hits, 0, eye, along, s)) continue;
    if (s.t < w.rig.depth_range->near_mm || s.t > w.rig.depth_range->far_mm) continue;
    const Vec3d point = eye + s.t * along;
    if (!in_picture(w.rig.projector, w.T_proj_cam * (s.t * ray))) continue;
    if (s.facet.dot((light - point).normalized()) < kLeastCos || -s.facet.dot(along.normalized()) < kLeastCos) continue;
    if (!w.is_free(point, light, s.facet)) continue;
    out.depth_mm[i] = static_cast<float>(s.t);
    out.sigma_mm[i] = static_cast<float>(kSigma_mm);
    out.points[i] = (s.t * ray).cast<float>();
    out.normals[i] = (T.linear().transpose() * s.facet).cast<float>();
    ++out.valid_px;
  }
  return out;
}

ShownSurface PlasterTable::surface() const {
  return {std::vector<std::uint8_t>(parts_->samples.size(), 0), parts_->area_mm2};
}

const std::vector<SurfaceSample>& PlasterTable::samples() const { return parts_->samples; }

void PlasterTable::show(const calib::AxisAngles& angles, double max_incidence_deg, ShownSurface& surface) const {
  const Pose T = parts_->T_model_camera(angles);
  const double least = std::cos(max_incidence_deg * calib::kRadPerDegree);
  for (std::size_t n = 0; n < surface.shown.size(); ++n) {
    if (surface.shown[n] == 0 && parts_->shows(T, parts_->samples[n], least)) surface.shown[n] = 1;
  }
}

}  // namespace enamel::test
