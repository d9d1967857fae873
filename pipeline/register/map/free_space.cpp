#include "pipeline/register/map/free_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pipeline/register/icp/viewpoint.hpp"

namespace enamel::pipeline {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// A measured pixel of the block, its middle first.
std::size_t measured_pixel(const SurfacePatch& patch, int u0, int v0, int block_px) {
  for (const auto& [du, dv] : {std::pair{2, 2}, {1, 1}, {3, 3}, {1, 3}, {3, 1}}) {
    const int u = u0 + du * block_px / 4, v = v0 + dv * block_px / 4;
    if (patch.points.contains(u, v) && std::isfinite(patch.points(u, v).x())) return patch.points.index(u, v);
  }
  return patch.points.size();
}

std::size_t clear(SurfacePatch& patch, int u0, int v0, int block_px) {
  std::size_t cleared = 0;
  for (int v = v0; v < std::min(v0 + block_px, patch.points.height()); ++v) {
    for (int u = u0; u < std::min(u0 + block_px, patch.points.width()); ++u) {
      const std::size_t i = patch.points.index(u, v);
      cleared += std::isnan(patch.depth_mm[i]) ? 0U : 1U;
      patch.depth_mm[i] = patch.sigma_mm[i] = kNan;
      patch.points[i] = patch.normals[i] = Vec3f::Constant(kNan);
    }
  }
  return cleared;
}

struct Cell {
  float z = kNan;  ///< NaN: nothing measured
  bool empty = false;
};

/// Cells of the piece of surface that hangs together with cell `from`; marks them as visited.
std::vector<std::size_t> piece_of(const Map<Cell>& cells, std::size_t from, float jump_mm, std::vector<bool>& visited) {
  std::vector<std::size_t> piece{from};
  visited[from] = true;
  const int width = cells.width();
  for (std::size_t next = 0; next < piece.size(); ++next) {
    const int u = static_cast<int>(piece[next]) % width, v = static_cast<int>(piece[next]) / width;
    for (const auto& [du, dv] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      if (!cells.contains(u + du, v + dv)) continue;
      const std::size_t other = cells.index(u + du, v + dv);
      if (visited[other] || !(std::abs(cells[other].z - cells[piece[next]].z) < jump_mm)) continue;
      visited[other] = true;
      piece.push_back(other);
    }
  }
  return piece;
}

/// A wrong order is wrong for all that was unwrapped with it.
void spread_over_pieces(Map<Cell>& cells, float jump_mm, double share) {
  std::vector<bool> visited(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (visited[i] || !cells[i].empty) continue;
    const std::vector<std::size_t> piece = piece_of(cells, i, jump_mm, visited);
    const auto empty = std::ranges::count_if(piece, [&](std::size_t k) { return cells[k].empty; });
    if (static_cast<double>(empty) < share * static_cast<double>(piece.size())) continue;
    for (const std::size_t k : piece) cells[k].empty = true;
  }
}

}  // namespace

FreeSpace::FreeSpace(std::shared_ptr<const MapNodes> nodes, std::vector<Pose> T_model_cam, const ViewCamera& camera,
                     double work_distance_mm, const FreeSpaceConfig& config)
    : nodes_(std::move(nodes)),
      T_model_cam_(std::move(T_model_cam)),
      camera_(camera),
      work_(0, 0, work_distance_mm),
      config_(config) {
  for (const Pose& T : T_model_cam_) {
    const Pose back = T.inverse();
    R_cam_model_.emplace_back(back.linear().cast<float>());
    t_cam_model_.emplace_back(back.translation().cast<float>());
  }
}

std::vector<FreeSpace::Asked> FreeSpace::keyframes_near(const Pose& T_model_cam) const {
  const Vec3d at = T_model_cam * work_;
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t k = 0; k < T_model_cam_.size(); ++k) {
    const double apart = (T_model_cam_[k] * work_ - at).norm();
    if (apart <= config_.reach_mm) near.emplace_back(apart, k);
  }
  std::ranges::sort(near);
  std::vector<Asked> out;
  for (const auto& [apart, k] : near) {
    if (out.size() == config_.asked) break;
    const Pose& T = T_model_cam_[k];
    const bool alike = std::ranges::any_of(out, [&](const Asked& other) {
      return look_alike(T, T_model_cam_[other.k], work_, {config_.apart_mm, config_.apart_deg});
    });
    if (!alike) out.push_back({k, nodes_->get(k)});
  }
  return out;
}

FreeSpace::Verdict FreeSpace::ask(const Asked& keyframe, const Vec3f& p_model) const {
  const Reference& reference = keyframe.node->reference;
  const Vec3f p = R_cam_model_[keyframe.k] * p_model + t_cam_model_[keyframe.k];
  if (!(p.z() > 1.0F)) return Verdict::kNothing;
  const Vec2f px = camera_.project(p);
  const float scale = reference.pixels_per_camera_pixel();
  const float u = px.x() * scale + 0.5F, v = px.y() * scale + 0.5F;
  const auto width = static_cast<float>(reference.width()), height = static_cast<float>(reference.height());
  if (!(u >= 0.0F && v >= 0.0F && u < width && v < height)) return Verdict::kNothing;
  const auto i =
      static_cast<std::size_t>(v) * static_cast<std::size_t>(reference.width()) + static_cast<std::size_t>(u);
  const Reference::Pixel& seen = reference.pixel(i);
  if (!std::isfinite(seen.point.x())) return Verdict::kNothing;
  if (std::abs(seen.normal.dot(p - seen.point)) < static_cast<float>(config_.same_mm)) return Verdict::kSeen;
  return seen.point.z() - p.z() > static_cast<float>(config_.through_mm) ? Verdict::kThrough : Verdict::kNothing;
}

bool FreeSpace::is_empty_space(const std::vector<Asked>& asked, const Vec3f& p_model) const {
  int through = 0, seen = 0;
  for (const Asked& keyframe : asked) {
    const Verdict verdict = ask(keyframe, p_model);
    through += verdict == Verdict::kThrough ? 1 : 0;
    seen += verdict == Verdict::kSeen ? 1 : 0;
  }
  return through >= config_.min_through && through > seen;
}

std::size_t FreeSpace::withdraw(const Pose& T_model_cam, SurfacePatch& patch) const {
  const std::vector<Asked> asked = keyframes_near(T_model_cam);
  const Eigen::Matrix3f R = T_model_cam.linear().cast<float>();
  const Vec3f t = T_model_cam.translation().cast<float>();
  const int block = config_.block_px;
  Map<Cell> cells((patch.points.width() + block - 1) / block, (patch.points.height() + block - 1) / block);
  for (int j = 0; j < cells.height(); ++j) {
    for (int i = 0; i < cells.width(); ++i) {
      const std::size_t at = measured_pixel(patch, i * block, j * block, block);
      if (at == patch.points.size()) continue;
      cells(i, j) = {patch.points[at].z(), is_empty_space(asked, R * patch.points[at] + t)};
    }
  }
  spread_over_pieces(cells, static_cast<float>(config_.through_mm), config_.whole_share);
  std::size_t cleared = 0;
  for (int j = 0; j < cells.height(); ++j) {
    for (int i = 0; i < cells.width(); ++i) {
      if (cells(i, j).empty) cleared += clear(patch, i * block, j * block, block);
    }
  }
  patch.valid_px -= cleared;
  return cleared;
}

}  // namespace enamel::pipeline
