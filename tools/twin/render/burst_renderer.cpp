#include "tools/twin/render/burst_renderer.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace enamel::twin {
namespace {

constexpr double kNearMm = 5, kFarMm = 250;  // camera z within which anything is seen
constexpr double kShadowOffsetMm = 2e-3;     // keeps a shadow ray off its own facet
constexpr int kRowsPerTask = 4;

void set_lane(RayPacket& rays, std::size_t i, const Vec3d& origin, const Vec3d& direction, double near, double far) {
  rays.ox[i] = static_cast<float>(origin.x());
  rays.oy[i] = static_cast<float>(origin.y());
  rays.oz[i] = static_cast<float>(origin.z());
  rays.dx[i] = static_cast<float>(direction.x());
  rays.dy[i] = static_cast<float>(direction.y());
  rays.dz[i] = static_cast<float>(direction.z());
  rays.near[i] = static_cast<float>(near);
  rays.far[i] = static_cast<float>(far);
  rays.active[i] = -1;
}

std::vector<double> ray_table(const Lens& lens, int width, int height, const std::vector<double>& dx,
                              const std::vector<double>& dy) {
  const std::size_t w = static_cast<std::size_t>(width), samples = dx.size();
  std::vector<double> table(w * static_cast<std::size_t>(height) * samples * 2);
  tbb::parallel_for(0, height, [&](int y) {
    double* out = table.data() + static_cast<std::size_t>(y) * samples * w * 2;
    for (std::size_t s = 0; s < samples; ++s) {
      for (int x = 0; x < width; ++x, out += 2) {
        const Eigen::Vector2d d = lens.direction(x + dx[s], y + dy[s]);
        out[0] = d.x();
        out[1] = d.y();
      }
    }
  });
  return table;
}

}  // namespace

SamplePattern::SamplePattern(int grid) {
  const double n = grid;
  for (int i = 0; i < grid; ++i) {
    for (int j = 0; j < grid; ++j) {
      dx.push_back((i + (j + 0.5) / n) / n - 0.5);
      dy.push_back((j + (n - 1 - i + 0.5) / n) / n - 0.5);
      order.push_back(static_cast<std::size_t>(j * grid + (grid - 1 - i)));
    }
  }
  // The two outermost rows of samples, first and last instants, go first: see agree().
  const auto swap_with = [&](std::size_t a, std::size_t b) {
    std::swap(dx[a], dx[b]);
    std::swap(dy[a], dy[b]);
    std::swap(order[a], order[b]);
  };
  const auto [lowest, highest] = std::minmax_element(dy.begin(), dy.end());
  const auto low = static_cast<std::size_t>(lowest - dy.begin()), high = static_cast<std::size_t>(highest - dy.begin());
  swap_with(0, low);
  if (dy.size() > 1) swap_with(1, high == 0 ? low : high);
}

/// Light and shade of a row's pixels as far as its first two samples tell.
enum class BurstRenderer::Shade : std::uint8_t { kUnknown, kDark, kLit };

/// The instrument at one pose, seen from the model.
struct BurstRenderer::View {
  Eigen::Matrix3d R_model_cam, R_proj_cam;
  Vec3d camera, projector, t_proj_cam;  // centres in model coordinates

  View(const Instrument& instrument, const Pose& T_model_cam)
      : R_model_cam(T_model_cam.linear()),
        R_proj_cam(instrument.T_proj_cam.linear()),
        camera(T_model_cam.translation()),
        projector(T_model_cam * instrument.T_proj_cam.inverse().translation()),
        t_proj_cam(instrument.T_proj_cam.translation()) {}
};

/// What one camera ray brings back.
struct BurstRenderer::Lane {
  bool hit = false, in_projector = false;
  bool faces = false;  // the facet is turned to the light
  bool lit = false;    // … and nothing stands between
  double z = 0;        // camera z
  double coord = 0;    // projector coordinate along the pattern axis
  double weight = 0;   // full-well fraction at emission 1
  double ambient = 0;
  double sigma2 = 0;  // projector blur
};

BurstRenderer::BurstRenderer(const Instrument& instrument, const RayScene& scene, const RenderConfig& config)
    : instrument_(instrument),
      scene_(scene),
      config_(config),
      pattern_(config.grid),
      width_(instrument.rig.camera.width),
      height_(instrument.rig.camera.height) {
  constexpr double kReferenceAlbedo = 0.8;
  const LightConfig& l = config.light;
  gain_ = l.reference_fraction / kReferenceAlbedo * (l.falloff ? l.reference_mm * l.reference_mm : 1.0);
  directions_ = ray_table(instrument.camera, width_, height_, pattern_.dx, pattern_.dy);
  centres_ = ray_table(instrument.camera, width_, height_, {0.0}, {0.0});
}

void BurstRenderer::darken(Lane& lane) {
  lane.lit = false;
  lane.weight = 0;
}

void BurstRenderer::light_lane(const View& view, const Vec3d& ray_cam, const RayScene::Surfel& s, Lane& lane) const {
  lane.hit = true;
  lane.z = s.t;
  lane.ambient = config_.light.ambient * static_cast<double>(s.albedo);
  const Vec3d p = view.R_proj_cam * (s.t * ray_cam) + view.t_proj_cam;
  double u = 0, v = 0;
  lane.in_projector = instrument_.projector.project(p.x(), p.y(), p.z(), u, v) && instrument_.projector.in_frame(u, v);
  if (!lane.in_projector) return;
  lane.coord = instrument_.light.axis_v() ? v : u;
  lane.sigma2 = instrument_.light.sigma2_at(p.z());
  const Vec3d to_light = view.projector - (view.camera + view.R_model_cam * (s.t * ray_cam));
  const double r2 = to_light.squaredNorm(), r = std::sqrt(r2);
  const double cosine = s.normal.dot(to_light) / r;
  lane.faces = lane.lit = s.facet.dot(to_light) > 0;
  if (!lane.lit || cosine <= 0) return;
  lane.weight = gain_ * static_cast<double>(s.albedo) * cosine;
  if (config_.light.falloff) {
    const double cp2 = p.z() * p.z() / r2;
    const double cc2 = 1.0 / ray_cam.squaredNorm();
    lane.weight *= cp2 * cp2 * cc2 * cc2 / r2;
    lane.ambient *= cc2 * cc2;
  }
}

void BurstRenderer::trace_packet(const View& view, const double* directions, const Shade* known, int x0,
                                 Lights& lights) const {
  RayPacket rays;
  HitPacket hits;
  std::array<Vec3d, kPacket> ray_cam, ray_model;
  const std::size_t n = static_cast<std::size_t>(std::min(static_cast<int>(kPacket), width_ - x0));
  for (std::size_t i = 0; i < n; ++i) {
    const double* d = directions + 2 * (static_cast<std::size_t>(x0) + i);
    ray_cam[i] = Vec3d(d[0], d[1], 1.0);
    ray_model[i] = view.R_model_cam * ray_cam[i];
    set_lane(rays, i, view.camera, ray_model[i], kNearMm, kFarMm);
  }
  scene_.intersect(rays, hits);
  RayPacket shadows;
  bool any = false;
  for (std::size_t i = 0; i < n; ++i) {
    lights[i] = Lane{};
    RayScene::Surfel s;
    if (hits.kind[i] == HitKind::kNone || !scene_.resolve(hits, i, view.camera, ray_model[i], s)) continue;
    light_lane(view, ray_cam[i], s, lights[i]);
    if (!lights[i].lit || !config_.light.shadow) continue;
    if (known != nullptr && known[static_cast<std::size_t>(x0) + i] != Shade::kUnknown) {
      if (known[static_cast<std::size_t>(x0) + i] == Shade::kDark) darken(lights[i]);
      continue;
    }
    const Vec3d origin = view.camera + s.t * ray_model[i];
    const Vec3d to_light = view.projector - origin;
    set_lane(shadows, i, origin, to_light, kShadowOffsetMm / to_light.norm(), 1.0);
    any = true;
  }
  if (!any) return;
  std::array<bool, kPacket> blocked{};
  scene_.occluded(shadows, blocked);
  for (std::size_t i = 0; i < n; ++i) {
    if (blocked[i]) darken(lights[i]);
  }
}

void BurstRenderer::add_light(const Lights& lights, std::size_t x0, std::size_t frame, bool all_frames,
                              RowSums& sums) const {
  const std::size_t n = std::min(kPacket, sums[0].size() - x0);
  for (std::size_t i = 0; i < n; ++i) {
    const Lane& lane = lights[i];
    if (!lane.hit) continue;
    const bool shines = lane.weight > 0;
    const auto tap = shines ? instrument_.light.tap(lane.coord, lane.sigma2) : ProjectorLight::Tap{};
    for (std::size_t k = frame; k < (all_frames ? 4 : frame + 1); ++k) {
      const float e = shines ? instrument_.light.emission(static_cast<int>(k), tap) : 0.0F;
      sums[k][x0 + i] += lane.weight * static_cast<double>(e) + lane.ambient;
    }
  }
}

/// Shade that the outer two samples of the pixel and of both its neighbours agree on: the samples between them, in
/// space and in time, then need no shadow ray of their own. A shadow missed so would be narrower than 0.02 mm.
void BurstRenderer::agree(const std::array<std::vector<Shade>, 2>& outer, std::vector<Shade>& known) {
  const std::size_t w = known.size();
  for (std::size_t x = 0; x < w; ++x) {
    Shade common = outer[0][x];
    for (std::size_t n = x == 0 ? 0 : x - 1; n <= std::min(x + 1, w - 1); ++n) {
      if (outer[0][n] != common || outer[1][n] != common) common = Shade::kUnknown;
    }
    known[x] = common;
  }
}

void BurstRenderer::render_row(const std::vector<View>& views, bool is_static, int y, RowSums& sums) const {
  const std::size_t samples = pattern_.dx.size(), w = static_cast<std::size_t>(width_);
  for (auto& s : sums) s.assign(w, 0.0);
  std::array<std::vector<Shade>, 2> outer{std::vector<Shade>(w), std::vector<Shade>(w)};
  std::vector<Shade> known(w, Shade::kUnknown);
  Lights lights;
  for (std::size_t frame = 0; frame < (is_static ? 1 : 4); ++frame) {
    for (std::size_t s = 0; s < samples; ++s) {
      const std::size_t instant = y % 2 == 0 ? pattern_.order[s] : samples - 1 - pattern_.order[s];
      const View& view = is_static ? views.front() : views[frame * samples + instant];
      const double* d = directions_.data() + (static_cast<std::size_t>(y) * samples + s) * w * 2;
      if (s == 2) agree(outer, known);
      const bool reuse = s >= 2 && !config_.every_shadow_ray;
      for (int x0 = 0; x0 < width_; x0 += static_cast<int>(kPacket)) {
        trace_packet(view, d, reuse ? known.data() : nullptr, x0, lights);
        const auto at = static_cast<std::size_t>(x0);
        add_light(lights, at, frame, is_static, sums);
        for (std::size_t i = 0; s < 2 && i < std::min(kPacket, w - at); ++i) {
          const Lane& lane = lights[i];
          outer[s][at + i] = !lane.faces ? Shade::kUnknown : (lane.lit ? Shade::kLit : Shade::kDark);
        }
      }
    }
  }
}

std::array<std::vector<float>, 4> BurstRenderer::render(const BurstPoses& poses) const {
  const std::size_t samples = pattern_.dx.size(), w = static_cast<std::size_t>(width_);
  std::vector<View> views;
  for (std::size_t k = 0; k < (poses.is_static ? 1 : 4); ++k) {
    for (std::size_t i = 0; i < samples; ++i) {
      views.emplace_back(instrument_, poses.is_static ? poses.mid : poses.frames[k][i]);
    }
  }
  std::array<std::vector<float>, 4> out;
  for (auto& image : out) image.resize(w * static_cast<std::size_t>(height_));
  tbb::parallel_for(tbb::blocked_range<int>(0, height_, kRowsPerTask), [&](const auto& range) {
    RowSums sums;
    for (int y = range.begin(); y < range.end(); ++y) {
      render_row(views, poses.is_static, y, sums);
      for (std::size_t k = 0; k < 4; ++k) {
        float* row = out[k].data() + static_cast<std::size_t>(y) * w;
        for (std::size_t x = 0; x < w; ++x) row[x] = static_cast<float>(sums[k][x] / static_cast<double>(samples));
      }
    }
  });
  return out;
}

void BurstRenderer::truth_row(const View& view, int y, TruthMaps& maps) const {
  constexpr double kNoOrder = 255;
  const std::size_t w = static_cast<std::size_t>(width_);
  const double* d = centres_.data() + static_cast<std::size_t>(y) * w * 2;
  Lights lights;
  for (int x0 = 0; x0 < width_; x0 += static_cast<int>(kPacket)) {
    trace_packet(view, d, nullptr, x0, lights);
    const std::size_t n = std::min(kPacket, w - static_cast<std::size_t>(x0));
    for (std::size_t i = 0; i < n; ++i) {
      const Lane& lane = lights[i];
      const std::size_t at = static_cast<std::size_t>(y) * w + static_cast<std::size_t>(x0) + i;
      maps.depth[at] = lane.hit ? static_cast<float>(lane.z) : std::numeric_limits<float>::quiet_NaN();
      maps.lit[at] = lane.lit ? 255 : 0;
      const double order = std::floor(lane.coord / instrument_.rig.patterns.period_px);
      maps.order[at] = static_cast<std::uint8_t>(lane.in_projector ? std::clamp(order, 0.0, kNoOrder) : kNoOrder);
    }
  }
}

TruthMaps BurstRenderer::truth(const Pose& T_model_cam) const {
  const View view(instrument_, T_model_cam);
  TruthMaps maps;
  const std::size_t n = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  maps.depth.resize(n);
  maps.lit.resize(n);
  maps.order.resize(n);
  tbb::parallel_for(tbb::blocked_range<int>(0, height_, kRowsPerTask), [&](const auto& range) {
    for (int y = range.begin(); y < range.end(); ++y) truth_row(view, y, maps);
  });
  return maps;
}

}  // namespace enamel::twin
