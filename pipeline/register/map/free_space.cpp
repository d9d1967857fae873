#include "pipeline/register/map/free_space.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "pipeline/types/viewpoint.hpp"

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

constexpr std::array<std::pair<int, int>, 4> kBeside{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

/// Cells of the piece of surface that hangs together with cell `from`; marks them as visited.
template <class Cell>
std::vector<std::size_t> piece_of(const Map<Cell>& cells, std::size_t from, float jump_mm, std::vector<bool>& visited) {
  std::vector<std::size_t> piece{from};
  visited[from] = true;
  const int width = cells.width();
  for (std::size_t next = 0; next < piece.size(); ++next) {
    const int u = static_cast<int>(piece[next]) % width, v = static_cast<int>(piece[next]) / width;
    for (const auto& [du, dv] : kBeside) {
      if (!cells.contains(u + du, v + dv)) continue;
      const std::size_t other = cells.index(u + du, v + dv);
      if (visited[other] || !(std::abs(cells[other].z - cells[piece[next]].z) < jump_mm)) continue;
      visited[other] = true;
      piece.push_back(other);
    }
  }
  return piece;
}

}  // namespace

struct FreeSpace::Cell {
  float z = kNan;  ///< NaN: nothing measured
  Votes votes;
  bool empty = false;
};

FreeSpace::FreeSpace(std::shared_ptr<const MapNodes> nodes, std::vector<MapBurst> seen_from, const ViewCamera& camera,
                     double work_distance_mm, const FreeSpaceConfig& config)
    : nodes_(std::move(nodes)),
      seen_from_(std::move(seen_from)),
      camera_(camera),
      work_(0, 0, work_distance_mm),
      config_(config) {
  for (const MapBurst& keyframe : seen_from_) {
    const Pose back = keyframe.T_model_cam.inverse();
    R_cam_model_.emplace_back(back.linear().cast<float>());
    t_cam_model_.emplace_back(back.translation().cast<float>());
  }
}

std::vector<FreeSpace::Asked> FreeSpace::keyframes_near(const MapBurst& burst) const {
  const Vec3d at = burst.T_model_cam * work_;
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t k = 0; k < seen_from_.size(); ++k) {
    const double apart = (seen_from_[k].T_model_cam * work_ - at).norm();
    if (apart <= config_.reach_mm) near.emplace_back(apart, k);
  }
  std::ranges::sort(near);
  std::vector<Asked> out;
  for (const auto& each : near) {
    if (out.size() == config_.asked) break;
    const std::size_t k = each.second;
    const Pose& T = seen_from_[k].T_model_cam;
    const bool alike = std::ranges::any_of(out, [&](const Asked& other) {
      return same_moment(seen_from_[k], seen_from_[other.k]) &&
             look_alike(T, seen_from_[other.k].T_model_cam, work_, {config_.apart_mm, config_.apart_deg});
    });
    if (!alike) out.push_back({k, nodes_->get(k), same_moment(seen_from_[k], burst)});
  }
  return out;
}

bool FreeSpace::same_moment(const MapBurst& a, const MapBurst& b) const {
  const std::chrono::duration<double> between = a.t_mid - b.t_mid;
  return std::abs(between.count()) < config_.moment_s;
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

FreeSpace::Votes FreeSpace::votes_on(const std::vector<Asked>& asked, const Vec3f& p_model) const {
  Votes votes;
  for (const Asked& keyframe : asked) {
    const Verdict verdict = ask(keyframe, p_model);
    votes.through += verdict == Verdict::kThrough ? 1 : 0;
    if (verdict == Verdict::kSeen) ++(keyframe.same_moment ? votes.seen_then : votes.seen_again);
  }
  return votes;
}

/// What enough looked through is empty; so is what hangs on that and has no more for it than against it.
void FreeSpace::judge(Map<Cell>& cells) const {
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Votes& votes = cells[i].votes;
    cells[i].empty = votes.through >= config_.min_through && votes.through > votes.in_favour();
    if (cells[i].empty) open.push_back(i);
  }
  for (std::size_t next = 0; next < open.size(); ++next) {
    const int u = static_cast<int>(open[next]) % cells.width(), v = static_cast<int>(open[next]) / cells.width();
    for (const auto& [du, dv] : kBeside) {
      if (!cells.contains(u + du, v + dv)) continue;
      Cell& cell = cells(u + du, v + dv);
      if (cell.empty || cell.votes.through == 0 || cell.votes.through < cell.votes.in_favour()) continue;
      cell.empty = true;
      open.push_back(cells.index(u + du, v + dv));
    }
  }
}

/// A body's rim is met by few rays: what only its own moment saw beside it goes with it.
void FreeSpace::clear_rim(Map<Cell>& cells) const {
  for (int round = 0; round < config_.rim_blocks; ++round) {
    std::vector<std::size_t> rim;
    for (int v = 0; v < cells.height(); ++v) {
      for (int u = 0; u < cells.width(); ++u) {
        const Cell& cell = cells(u, v);
        if (cell.empty || std::isnan(cell.z) || cell.votes.seen_again > 0) continue;
        const bool beside = std::ranges::any_of(kBeside, [&](const auto& step) {
          return cells.contains(u + step.first, v + step.second) && cells(u + step.first, v + step.second).empty;
        });
        if (beside) rim.push_back(cells.index(u, v));
      }
    }
    for (const std::size_t i : rim) cells[i].empty = true;
  }
}

/// A wrong order is wrong for all that was unwrapped with it, and a passing body is one piece: it goes as a whole where
/// most of it is empty, or some of it and more of it was looked through than any other moment saw.
void FreeSpace::clear_pieces(Map<Cell>& cells) const {
  std::vector<bool> visited(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (visited[i] || cells[i].votes.through == 0) continue;
    const auto jump = static_cast<float>(config_.piece_jump_mm);
    const std::vector<std::size_t> piece = piece_of(cells, i, jump, visited);
    std::size_t empty = 0, doubted = 0, again = 0;
    for (const std::size_t k : piece) {
      const Votes& votes = cells[k].votes;
      empty += cells[k].empty ? 1U : 0U;
      doubted += votes.through > 0 && votes.through >= votes.in_favour() ? 1U : 0U;
      again += votes.seen_again > 0 ? 1U : 0U;
    }
    const auto size = static_cast<double>(piece.size());
    const bool passing = empty > 0 && doubted > again && static_cast<double>(doubted) >= config_.doubted_share * size;
    if (!passing && static_cast<double>(empty) < config_.whole_share * size) continue;
    for (const std::size_t k : piece) cells[k].empty = true;
  }
}

std::size_t FreeSpace::withdraw(const MapBurst& burst, SurfacePatch& patch) const {
  const std::vector<Asked> asked = keyframes_near(burst);
  const Eigen::Matrix3f R = burst.T_model_cam.linear().cast<float>();
  const Vec3f t = burst.T_model_cam.translation().cast<float>();
  const int block = config_.block_px;
  Map<Cell> cells((patch.points.width() + block - 1) / block, (patch.points.height() + block - 1) / block);
  for (int j = 0; j < cells.height(); ++j) {
    for (int i = 0; i < cells.width(); ++i) {
      const std::size_t at = measured_pixel(patch, i * block, j * block, block);
      if (at == patch.points.size()) continue;
      cells(i, j) = {patch.points[at].z(), votes_on(asked, R * patch.points[at] + t)};
    }
  }
  judge(cells);
  clear_pieces(cells);
  clear_rim(cells);
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
