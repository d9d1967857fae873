#include "tests/support/molar_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <utility>

#include "calib/model/lens.hpp"
#include "pipeline/decode/triangulate/normals.hpp"
#include "tools/twin/jaw/strip.hpp"
#include "tools/twin/mount/mount.hpp"
#include "tools/twin/optics/random.hpp"
#include "tools/twin/scene/scene.hpp"
#include "tools/twin/surface/ray_scene.hpp"

namespace enamel::test {
namespace {

constexpr double kRad = std::numbers::pi / 180;
constexpr double kWork_mm = 48;
constexpr double kApart_deg = 15;             // as the stops of config/scenes/desktop_arch.toml
constexpr double kSigma_mm = 0.0085;          // of a surface that faces the projector: the design's shot limit
constexpr double kLeastCos = 0.26;            // 75 degrees, to camera and to light
constexpr double kFrom_mm = 18, kTo_mm = 62;  // of the arch: from the canine to behind the second molar
constexpr double kEdge_mm = 0.12;

template <class T>
T need(Result<T> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "%s\n", result.error().message().c_str());
  std::exit(exit_code(result.error().code));
}

twin::Dentition teeth(Molars kind, std::uint64_t seed) {
  twin::Dentition out = twin::make_dentition(twin::JawSide::kLower, 7, false, seed);
  for (twin::PlacedTooth& t : out.teeth) {
    const bool back = t.form.kind == twin::ToothKind::kMolar || t.form.kind == twin::ToothKind::kPremolar;
    if (kind != Molars::kSmooth || !back) continue;
    t.form.cusps = {{0, 0, t.form.height - 0.8, 0.2}};
    t.form.side_grooves.clear();
    t.form.rounding = 1.8;
  }
  return out;
}

twin::TriSurface plaster(const twin::Dentition& dentition, std::uint64_t seed) {
  const twin::JawField field(dentition, twin::JawSide::kLower, seed);
  const twin::Strip strip{kFrom_mm, kTo_mm, 9.5, 8.0, -13, 13};
  twin::TriSurface mesh =
      twin::mesh_strip(strip, twin::Arch(dentition.shape), field.coordinates(), {kEdge_mm, twin::JawField::kLipschitz},
                       [&](const Vec3d& p) { return field.value(p); });
  mesh.albedo.assign(mesh.vertices.size(), 0.8F);
  return mesh;
}

void set_ray(twin::RayPacket& rays, std::size_t lane, const Vec3d& from, const Vec3d& along) {
  const Vec3f o = from.cast<float>(), d = along.cast<float>();
  rays.ox[lane] = o.x(), rays.oy[lane] = o.y(), rays.oz[lane] = o.z();
  rays.dx[lane] = d.x(), rays.dy[lane] = d.y(), rays.dz[lane] = d.z();
  rays.active[lane] = -1;
}

/// Depth and sigma of one pixel; NaN: nothing to be measured.
struct Seen {
  double z = std::numeric_limits<double>::quiet_NaN(), sigma = 0;
};

}  // namespace

struct MolarTable::Parts {
  twin::SceneConfig scene;
  calib::Rig rig;
  twin::Dentition dentition;
  twin::RayScene jaw;
  twin::MountRun run;
  pipeline::RayDepth rays;

  [[nodiscard]] Seen look(const Pose& T_jaw_camera, const Vec3d& ray) const;
  [[nodiscard]] SurfacePatch patch(const Pose& T_jaw_camera, std::uint64_t noise_seed) const;
  [[nodiscard]] twin::StopTruth stop_before(int tooth, double swing_deg) const;
};

/// ray: camera frame, z 1.
Seen MolarTable::Parts::look(const Pose& T_jaw_camera, const Vec3d& ray) const {
  const Vec3d eye = T_jaw_camera.translation(), along = T_jaw_camera.linear() * ray;
  twin::RayPacket packet;
  set_ray(packet, 0, eye, along);
  packet.near[0] = 5, packet.far[0] = 250;
  twin::HitPacket hits;
  jaw.intersect(packet, hits);
  twin::RayScene::Surfel s;
  if (hits.kind[0] == twin::HitKind::kNone || !jaw.resolve(hits, 0, eye, along, s)) return {};
  if (s.t < rig.depth_range->near_mm || s.t > rig.depth_range->far_mm) return {};
  const Vec3d point = eye + s.t * along;
  const Vec3d to_light = T_jaw_camera * rays.projector_mm.cast<double>() - point;
  const double lit = s.normal.dot(to_light.normalized());
  if (lit < kLeastCos || -s.normal.dot(along.normalized()) < kLeastCos) return {};
  set_ray(packet, 0, point, to_light);
  packet.near[0] = static_cast<float>(2e-3 / to_light.norm()), packet.far[0] = 1;
  std::array<bool, twin::kPacket> blocked{};
  jaw.occluded(packet, blocked);
  return blocked[0] ? Seen{} : Seen{s.t, kSigma_mm / std::sqrt(lit)};
}

SurfacePatch MolarTable::Parts::patch(const Pose& T_jaw_camera, std::uint64_t noise_seed) const {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const int width = rig.camera.width, height = rig.camera.height;
  const twin::CounterRandom random(noise_seed, 91);
  SurfacePatch out;
  out.depth_mm = Map<float>(width, height, kNan);
  out.sigma_mm = out.depth_mm;
  Map<float> inverse = out.depth_mm;
  out.points = Map<Vec3f>(width, height, Vec3f::Constant(kNan));
  out.normals = out.points;
  out.texture_dn = Map<float>(width, height, 100.0F);
  out.modulation_dn = Map<float>(width, height, 50.0F);
  for (std::size_t i = 0; i < out.depth_mm.size(); ++i) {
    const Vec3d ray(static_cast<double>(rays.rays.x[i]), static_cast<double>(rays.rays.y[i]), 1);
    const Seen seen = look(T_jaw_camera, ray);
    if (std::isnan(seen.z)) continue;
    const double z = seen.z + seen.sigma * random.normals(i).a;
    out.depth_mm[i] = static_cast<float>(z);
    inverse[i] = static_cast<float>(1 / z);
    out.sigma_mm[i] = static_cast<float>(seen.sigma);
    out.points[i] = (z * ray).cast<float>();
    ++out.valid_px;
  }
  std::vector<float> scratch;
  pipeline::compute_normals(rays, inverse, out.sigma_mm, {}, scratch, out.normals);
  return out;
}

/// The stop at this swing at which the tooth's crown lies nearest to the camera's axis.
twin::StopTruth MolarTable::Parts::stop_before(int tooth, double swing_deg) const {
  const twin::PlacedTooth& t = dentition.teeth[static_cast<std::size_t>(tooth - 1)];
  const Vec3d crown = t.origin + t.R * Vec3d(0, 0, 0.5 * t.form.height);
  twin::StopTruth best;
  double least = std::numeric_limits<double>::max();
  for (const twin::StopTruth& stop : run.stops) {
    if (std::abs(stop.swing_cmd - kRad * swing_deg) > 1e-6) continue;
    const double off = (twin::T_model_camera(run.mount, stop).inverse() * crown).head<2>().norm();
    if (off < least) least = off, best = stop;
  }
  return best;
}

MolarTable::MolarTable(const std::string& scene_file, Molars kind, std::uint64_t seed) {
  twin::SceneConfig scene = need(twin::load_scene(scene_file));
  calib::Rig rig = need(calib::load_rig(std::string(ENAMEL_SOURCE_DIR) + "/config/rigs/probe.json"));
  twin::Dentition dentition = teeth(kind, seed);
  twin::Surroundings surroundings;
  surroundings.mesh = plaster(dentition, seed);
  surroundings.materials = twin::default_materials();
  twin::MountRun run = twin::drive(scene.mount, seed);
  pipeline::RayDepth rays = need(pipeline::RayDepth::bake(rig, *rig.depth_range));
  parts_.reset(new Parts{std::move(scene), std::move(rig), std::move(dentition),
                         twin::RayScene(std::move(surroundings)), std::move(run), std::move(rays)});
}

MolarTable::~MolarTable() = default;

const calib::Rig& MolarTable::rig() const { return parts_->rig; }

MolarPair MolarTable::pair(int tooth, double swing_deg, std::uint64_t noise_seed) const {
  MolarPair out;
  out.tooth = tooth;
  out.swing_deg = swing_deg;
  twin::StopTruth stop = parts_->stop_before(tooth, swing_deg);
  out.T_jaw_patch = twin::T_model_camera(parts_->run.mount, stop);
  stop.rot += kRad * kApart_deg;
  out.T_jaw_reference = twin::T_model_camera(parts_->run.mount, stop);
  out.patch = parts_->patch(out.T_jaw_patch, 2 * noise_seed);
  out.reference = parts_->patch(out.T_jaw_reference, 2 * noise_seed + 1);
  return out;
}

Pose drawn_start(const Pose& truth, double shift_mm, double turn_deg, std::uint64_t seed) {
  const twin::CounterRandom random(seed, 92);
  const auto direction = [&](std::uint64_t first) {
    const auto a = random.normals(first), b = random.normals(first + 1);
    return Vec3d(a.a, a.b, b.a).normalized();
  };
  const Vec3d at = truth * Vec3d(0, 0, kWork_mm);
  const Vec3d axis = direction(0), shift = shift_mm * direction(2);
  return Eigen::Translation3d(shift) * twin::turn_about(axis, at, kRad * turn_deg) * truth;
}

PoseError pose_error(const Pose& found, const Pose& truth) {
  const Vec3d at(0, 0, kWork_mm);
  return {1e3 * (found * at - truth * at).norm(),
          Eigen::AngleAxisd(truth.linear().transpose() * found.linear()).angle() / kRad};
}

}  // namespace enamel::test
