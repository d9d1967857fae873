// The only file that knows Embree.
#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <utility>

#include "tools/twin/surface/ray_scene.hpp"

namespace enamel::twin {
namespace {

constexpr unsigned kTriangleGeometry = 0;
constexpr unsigned kBallGeometry = 1;

/// What shading needs of a vertex, in half a cache line: the mesh is large and hits are scattered.
struct alignas(32) ShadeVertex {
  Vec3f position, normal;
  float albedo;
  std::uint16_t film;  // thickness in kFilmStepMm
  std::uint8_t level;  // 255: level
  std::uint8_t material;
};
static_assert(sizeof(ShadeVertex) == 32);
constexpr float kFilmStepMm = 1e-4F;  // 6.5 mm at most
constexpr float kLevelSteps = 255;

ShadeVertex shade_vertex(const TriSurface& mesh, std::size_t i) {
  ShadeVertex v{mesh.vertices[i], mesh.normals[i], mesh.albedo[i], 0, 0, 0};
  if (!mesh.material.empty()) v.material = mesh.material[i];
  if (!mesh.film.empty()) {
    constexpr float kMost = 65535;
    v.film = static_cast<std::uint16_t>(std::lround(std::clamp(mesh.film[i].thickness_mm / kFilmStepMm, 0.0F, kMost)));
    v.level = static_cast<std::uint8_t>(std::lround(kLevelSteps * std::clamp(mesh.film[i].level, 0.0F, 1.0F)));
  }
  return v;
}

void copy(const Lanes& from, float* to) { std::memcpy(to, from.data(), sizeof(Lanes)); }

void load(const RayPacket& rays, RTCRay8& out) {
  copy(rays.ox, out.org_x);
  copy(rays.oy, out.org_y);
  copy(rays.oz, out.org_z);
  copy(rays.dx, out.dir_x);
  copy(rays.dy, out.dir_y);
  copy(rays.dz, out.dir_z);
  copy(rays.near, out.tnear);
  copy(rays.far, out.tfar);
  for (std::size_t i = 0; i < kPacket; ++i) {
    out.time[i] = 0;
    out.mask[i] = 0xFFFFFFFFU;
    out.flags[i] = 0;
  }
}

}  // namespace

struct RayScene::Backend {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<ShadeVertex> vertices;

  Backend() {
    device = rtcNewDevice(nullptr);
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
  }
  ~Backend() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;

  void add(const TriSurface& mesh) {
    if (mesh.triangles.empty()) return;
    vertices.reserve(mesh.vertices.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      vertices.push_back(shade_vertex(mesh, i));
    }
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                          3 * sizeof(float), mesh.vertices.size()));
    std::memcpy(v, mesh.vertices.front().data(), mesh.vertices.size() * 3 * sizeof(float));
    auto* t = static_cast<unsigned*>(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                             3 * sizeof(unsigned), mesh.triangles.size()));
    std::memcpy(t, mesh.triangles.front().data(), mesh.triangles.size() * 3 * sizeof(unsigned));
    attach(g, kTriangleGeometry);
  }

  void add(const std::vector<Ball>& balls) const {
    if (balls.empty()) return;
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    auto* v = static_cast<float*>(
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), balls.size()));
    for (std::size_t i = 0; i < balls.size(); ++i) {
      for (int k = 0; k < 3; ++k) v[4 * i + static_cast<std::size_t>(k)] = static_cast<float>(balls[i].centre[k]);
      v[4 * i + 3] = static_cast<float>(balls[i].radius);
    }
    attach(g, kBallGeometry);
  }

 private:
  void attach(RTCGeometry g, unsigned id) const {
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(scene, g, id);
    rtcReleaseGeometry(g);
  }
};

RayScene::RayScene(Surroundings surroundings)
    : surroundings_(std::move(surroundings)), backend_(std::make_unique<Backend>()) {
  backend_->add(surroundings_.mesh);
  backend_->add(surroundings_.balls);
  rtcCommitScene(backend_->scene);
}

RayScene::~RayScene() = default;

void RayScene::intersect(const RayPacket& rays, HitPacket& hits) const {
  RTCRayHit8 rh;
  load(rays, rh.ray);
  std::fill_n(std::begin(rh.hit.geomID), kPacket, RTC_INVALID_GEOMETRY_ID);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(rays.active.data(), backend_->scene, &context, &rh);
  for (std::size_t i = 0; i < kPacket; ++i) {
    const unsigned geometry = rays.active[i] != 0 ? rh.hit.geomID[i] : RTC_INVALID_GEOMETRY_ID;
    hits.kind[i] = geometry == kTriangleGeometry ? HitKind::kTriangle
                   : geometry == kBallGeometry   ? HitKind::kBall
                                                 : HitKind::kNone;
    hits.index[i] = rh.hit.primID[i];
    hits.u[i] = rh.hit.u[i];
    hits.v[i] = rh.hit.v[i];
    hits.t[i] = rh.ray.tfar[i];
  }
}

void RayScene::occluded(const RayPacket& rays, std::array<bool, kPacket>& blocked) const {
  RTCRay8 r;
  load(rays, r);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded8(rays.active.data(), backend_->scene, &context, &r);
  for (std::size_t i = 0; i < kPacket; ++i) blocked[i] = rays.active[i] != 0 && r.tfar[i] < 0;
}

bool RayScene::resolve(const HitPacket& hits, std::size_t i, const Vec3d& origin, const Vec3d& direction,
                       Surfel& out) const {
  if (hits.kind[i] == HitKind::kBall) {
    const Ball& ball = surroundings_.balls[hits.index[i]];
    const Vec3d oc = origin - ball.centre;
    const double a = direction.squaredNorm(), b = oc.dot(direction), c = oc.squaredNorm() - ball.radius * ball.radius;
    const double q = b * b - a * c;
    if (q < 0) return false;
    out.t = (-b - std::sqrt(q)) / a;
    out.facet = (oc + out.t * direction) / ball.radius;
    out.normal = out.facet;
    out.albedo = ball.albedo;
    out.material = ball.material;
    return true;
  }
  const auto& t = surroundings_.mesh.triangles[hits.index[i]];
  const ShadeVertex &v0 = backend_->vertices[t[0]], &v1 = backend_->vertices[t[1]], &v2 = backend_->vertices[t[2]];
  const Vec3d a = v0.position.cast<double>();
  const Vec3d ab = v1.position.cast<double>() - a, ac = v2.position.cast<double>() - a;
  const Vec3d n = ab.cross(ac);
  const double facing = n.dot(direction);
  if (facing >= 0) return false;
  out.t = n.dot(a - origin) / facing;
  out.facet = n / n.norm();
  const float u = hits.u[i], v = hits.v[i], w = 1.0F - u - v;
  const Vec3f s = w * v0.normal + u * v1.normal + v * v2.normal;
  out.normal = s.cast<double>() / static_cast<double>(s.norm());
  out.albedo = w * v0.albedo + u * v1.albedo + v * v2.albedo;
  // Materials meet at the middle between vertices.
  out.material = (w >= u && w >= v ? v0 : (u >= v ? v1 : v2)).material;
  if ((v0.film | v1.film | v2.film) != 0) {
    const auto mixed = [&](auto a0, auto a1, auto a2) {
      return w * static_cast<float>(a0) + u * static_cast<float>(a1) + v * static_cast<float>(a2);
    };
    out.film_mm = kFilmStepMm * mixed(v0.film, v1.film, v2.film);
    out.level = mixed(v0.level, v1.level, v2.level) / kLevelSteps;
  }
  if (surroundings_.print) out.albedo = surroundings_.print->albedo(origin + out.t * direction);
  return true;
}

}  // namespace enamel::twin
