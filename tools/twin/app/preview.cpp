#include "tools/twin/app/preview.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <utility>

#include "tools/twin/surface/ray_scene.hpp"

namespace enamel::twin {
namespace {

constexpr int kTileWidth = 800, kTileHeight = 600;

/// Orthographic, light from above the viewer's shoulder.
struct Shot {
  Vec3d x, y, z, light, centre;
  double mm_per_px;

  Shot(const Vec3d& towards_viewer, const Vec3d& middle, double scale) : centre(middle), mm_per_px(scale) {
    z = towards_viewer.normalized();
    const Vec3d up = std::abs(z.z()) > 0.99 ? Vec3d::UnitY() : Vec3d::UnitZ();
    x = up.cross(z).normalized();
    y = z.cross(x);
    light = (z + 0.5 * x + 0.8 * y).normalized();
  }
  [[nodiscard]] Vec3d origin(int column, int row) const {
    constexpr double kAwayMm = 200;
    return centre + x * ((column - 0.5 * kTileWidth) * mm_per_px) - y * ((row - 0.5 * kTileHeight) * mm_per_px) +
           z * kAwayMm;
  }
};

void put(RayPacket& rays, std::size_t i, const Vec3d& o, const Vec3d& d, float near) {
  rays.ox[i] = static_cast<float>(o.x());
  rays.oy[i] = static_cast<float>(o.y());
  rays.oz[i] = static_cast<float>(o.z());
  rays.dx[i] = static_cast<float>(d.x());
  rays.dy[i] = static_cast<float>(d.y());
  rays.dz[i] = static_cast<float>(d.z());
  rays.near[i] = near;
  rays.far[i] = 1000.0F;
  rays.active[i] = -1;
}

cv::Vec3b colour(const RayScene::Surfel& s, const Shot& shot, bool shadow) {
  const double direct = shadow ? 0.0 : 0.42 * std::max(0.0, s.normal.dot(shot.light));
  const double light = 0.22 + 0.36 * std::max(0.0, s.normal.dot(shot.z)) + direct;
  const bool tooth = s.albedo > 0.605F;
  const Vec3d rgb = (tooth ? Vec3d(236, 231, 212) : Vec3d(214, 128, 126)) * light * (tooth ? s.albedo / 0.8F : 1.0F);
  const auto byte = [](double v) { return static_cast<unsigned char>(std::min(255.0, v)); };
  return {byte(rgb.z()), byte(rgb.y()), byte(rgb.x())};
}

void draw_row(const RayScene& scene, const Shot& shot, int row, cv::Mat& tile) {
  for (int x0 = 0; x0 < kTileWidth; x0 += static_cast<int>(kPacket)) {
    RayPacket rays, shadows;
    HitPacket hits;
    std::array<RayScene::Surfel, kPacket> surfels;
    std::array<bool, kPacket> hit{}, blocked{};
    for (std::size_t i = 0; i < kPacket; ++i) put(rays, i, shot.origin(x0 + static_cast<int>(i), row), -shot.z, 0.0F);
    scene.intersect(rays, hits);
    for (std::size_t i = 0; i < kPacket; ++i) {
      const Vec3d o = shot.origin(x0 + static_cast<int>(i), row);
      hit[i] = hits.kind[i] != HitKind::kNone && scene.resolve(hits, i, o, -shot.z, surfels[i]);
      if (hit[i]) put(shadows, i, o - surfels[i].t * shot.z, shot.light, 0.01F);
    }
    scene.occluded(shadows, blocked);
    for (std::size_t i = 0; i < kPacket; ++i) {
      if (hit[i]) tile.at<cv::Vec3b>(row, x0 + static_cast<int>(i)) = colour(surfels[i], shot, blocked[i]);
    }
  }
}

}  // namespace

Result<void> write_preview(const SceneConfig& config, const std::string& path) {
  SceneConfig plain = config;
  plain.effects.texture = false;  // gum and tooth are told apart by their reflectance
  plain.look = LookConfig{};
  ENAMEL_TRY_ASSIGN(Body body, make_body(plain));
  const TriSurface truth = truth_mesh(body.surroundings, 0.1);
  Vec3f low = truth.vertices.front(), high = low;
  for (const auto& v : truth.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  const RayScene scene(std::move(body.surroundings));
  const Vec3d middle = (0.5F * (low + high)).cast<double>();
  const double scale = static_cast<double>((high - low).head<2>().norm()) / kTileWidth;
  const std::array<Vec3d, 4> views{Vec3d(0, 0, 1), Vec3d(0.9, 0.35, 0.25), Vec3d(-0.85, -0.1, 0.75),
                                   Vec3d(0.35, 1, 0.35)};
  cv::Mat sheet(2 * kTileHeight, 2 * kTileWidth, CV_8UC3, cv::Scalar(40, 30, 30));
  for (int i = 0; i < 4; ++i) {
    cv::Mat tile = sheet(cv::Rect((i % 2) * kTileWidth, (i / 2) * kTileHeight, kTileWidth, kTileHeight));
    const Shot shot(views[static_cast<std::size_t>(i)], middle, scale);
    tbb::parallel_for(0, kTileHeight, [&](int row) { draw_row(scene, shot, row, tile); });
  }
  try {
    if (cv::imwrite(path, sheet)) return {};
  } catch (const cv::Exception& e) {
    return fail(ErrorCode::kFileWrite, path + ": " + e.what());
  }
  return fail(ErrorCode::kFileWrite, path);
}

}  // namespace enamel::twin
