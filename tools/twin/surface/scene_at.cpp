#include "tools/twin/surface/scene_at.hpp"

namespace enamel::twin {
namespace {

/// The rays in the guest's frame; parameters along them stay what they are.
RayPacket moved(const RayPacket& rays, const Guest& guest) {
  RayPacket out = rays;
  const Eigen::Matrix3d& R = guest.T_guest_model.linear();
  for (std::size_t i = 0; i < kPacket; ++i) {
    if (rays.active[i] == 0) continue;
    const Vec3d origin = guest.T_guest_model * Vec3f(rays.ox[i], rays.oy[i], rays.oz[i]).cast<double>();
    const Vec3d direction = R * Vec3f(rays.dx[i], rays.dy[i], rays.dz[i]).cast<double>();
    out.ox[i] = static_cast<float>(origin.x());
    out.oy[i] = static_cast<float>(origin.y());
    out.oz[i] = static_cast<float>(origin.z());
    out.dx[i] = static_cast<float>(direction.x());
    out.dy[i] = static_cast<float>(direction.y());
    out.dz[i] = static_cast<float>(direction.z());
  }
  return out;
}

}  // namespace

void SceneAt::intersect(const RayPacket& rays, HitPacket& hits) const {
  still_.intersect(rays, hits);
  hits.guest.fill(0);
  HitPacket own;
  for (std::size_t g = 0; g < guests_.size(); ++g) {
    guests_[g].scene->intersect(moved(rays, guests_[g]), own);
    for (std::size_t i = 0; i < kPacket; ++i) {
      if (own.kind[i] == HitKind::kNone || (hits.kind[i] != HitKind::kNone && hits.t[i] <= own.t[i])) continue;
      hits.kind[i] = own.kind[i];
      hits.index[i] = own.index[i];
      hits.u[i] = own.u[i];
      hits.v[i] = own.v[i];
      hits.t[i] = own.t[i];
      hits.guest[i] = static_cast<std::uint8_t>(g + 1);
    }
  }
}

void SceneAt::occluded(const RayPacket& rays, std::array<bool, kPacket>& blocked) const {
  still_.occluded(rays, blocked);
  std::array<bool, kPacket> own{};
  for (const Guest& guest : guests_) {
    guest.scene->occluded(moved(rays, guest), own);
    for (std::size_t i = 0; i < kPacket; ++i) blocked[i] = blocked[i] || own[i];
  }
}

bool SceneAt::resolve(const HitPacket& hits, std::size_t i, const Vec3d& origin, const Vec3d& direction,
                      RayScene::Surfel& out) const {
  if (hits.guest[i] == 0) return still_.resolve(hits, i, origin, direction, out);
  const Guest& guest = guests_[hits.guest[i] - std::size_t{1}];
  const Eigen::Matrix3d& R = guest.T_guest_model.linear();
  if (!guest.scene->resolve(hits, i, guest.T_guest_model * origin, R * direction, out)) return false;
  out.facet = R.transpose() * out.facet;
  out.normal = R.transpose() * out.normal;
  return true;
}

}  // namespace enamel::twin
