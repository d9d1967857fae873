#include "tools/twin/movers/mover_stage.hpp"

#include "tools/twin/optics/random.hpp"

namespace enamel::twin {
namespace {

constexpr double kUsualDepthMm = 48;  // where the probe looks past the mouth

std::shared_ptr<const RayScene> scene_of(const MoverConfig& config, const Bend& bend, std::uint64_t seed) {
  return std::make_shared<const RayScene>(Surroundings{mover_mesh(config, bend, seed), {}});
}

/// How far along the camera's axis the mouth is.
double depth_of(const RayScene& mouth, const Pose& T_model_cam) {
  constexpr float kNearMm = 20, kFarMm = 80;
  RayPacket rays;
  const Vec3f o = T_model_cam.translation().cast<float>(), d = T_model_cam.linear().col(2).cast<float>();
  rays.ox[0] = o.x(), rays.oy[0] = o.y(), rays.oz[0] = o.z();
  rays.dx[0] = d.x(), rays.dy[0] = d.y(), rays.dz[0] = d.z();
  rays.near[0] = kNearMm, rays.far[0] = kFarMm, rays.active[0] = -1;
  HitPacket hits;
  mouth.intersect(rays, hits);
  return hits.kind[0] == HitKind::kNone ? kUsualDepthMm : static_cast<double>(hits.t[0]);
}

/// Axes of the place looked at: along the camera's x, towards the probe, and outwards where x is the arch's tangent.
Pose place_of(const Pose& T_model_cam, double depth_mm) {
  Pose out = Pose::Identity();
  const Vec3d x = T_model_cam.linear().col(0), z = -T_model_cam.linear().col(2);
  out.linear().col(0) = x;
  out.linear().col(1) = z.cross(x);
  out.linear().col(2) = z;
  out.translation() = T_model_cam.translation() - depth_mm * z;
  return out;
}

}  // namespace

MoverStage::MoverStage(const std::vector<MoverConfig>& movers, std::uint64_t seed, const RayScene& mouth,
                       const Trajectory& path, double scan_s)
    : configs_(movers) {
  LookedAt looked_at;
  looked_at.place = [&mouth, &path](double t_s) {
    const Pose T_model_cam = path.pose_at(t_s);
    return place_of(T_model_cam, depth_of(mouth, T_model_cam));
  };
  looked_at.way = [&path](double t_s) { return path.pose_at(t_s) * Vec3d(0, 0, kUsualDepthMm); };
  for (std::size_t i = 0; i < movers.size(); ++i) {
    seeds_.push_back(mix64(seed ^ mix64(movers[i].seed + (i << 32U))));
    motions_.emplace_back(movers[i], seeds_.back(), scan_s, looked_at);
    const bool soft = mover_form(movers[i].kind).soft;
    rigid_.push_back(soft ? nullptr : scene_of(movers[i], {}, seeds_.back()));
  }
}

BurstGuests MoverStage::at(const BurstInstants& instants) const {
  BurstGuests out;
  for (std::size_t k = 0; k < 4; ++k) out.frames[k].resize(instants.frames[k].size());
  for (std::size_t i = 0; i < motions_.size(); ++i) {
    const auto mid = motions_[i].at(instants.mid);
    if (!mid) continue;
    const auto scene = rigid_[i] ? rigid_[i] : scene_of(configs_[i], motions_[i].bend(instants.mid), seeds_[i]);
    out.movers.push_back(i);
    out.mid.push_back({scene, mid->inverse()});
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t n = 0; n < instants.frames[k].size(); ++n) {
        out.frames[k][n].push_back({scene, motions_[i].at(instants.frames[k][n]).value_or(*mid).inverse()});
      }
    }
  }
  return out;
}

}  // namespace enamel::twin
