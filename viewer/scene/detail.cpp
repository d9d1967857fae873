#include "viewer/scene/detail.hpp"

#include <algorithm>
#include <cmath>

namespace enamel::view {
namespace {

constexpr double kFinestPx = 1.0;             // chosen: cells below a pixel are not seen
constexpr double kStep = 1.4142135623730951;  // of the tolerance, from one try to the next
constexpr int kTries = 28;                    // up to 16384 pixels
constexpr double kFocusShare = 1.0 / 16;      // chosen: all else is at its coarsest before the focus gives up any
constexpr double kRoom = 0.75;                // chosen: of a frame's target; above it nothing gets finer
constexpr double kKeep = 0.8;  // chosen: a level that is nearly coarse enough is kept, so that none flickers

struct Seen {
  std::size_t part = 0;
  double depth_mm = 0;
  double px_per_mm = 0;  ///< by the tolerance's share of the focus
};

/// Whether any of the ball is between the four sides of the view and before the eye.
bool in_view(const Vec3d& centre, double radius, double tan_x, double tan_y) {
  if (-centre.z() + radius <= 0) return false;
  const auto beyond = [&](double across, double tangent) {
    return (std::abs(across) + tangent * centre.z()) > radius * std::sqrt(1 + tangent * tangent);
  };
  return !beyond(centre.x(), tan_x) && !beyond(centre.y(), tan_y);
}

std::vector<Seen> seen_parts(std::span<const DetailPart> parts, const DetailView& view) {
  const Eigen::Matrix4d T_view_model = view_matrix(view.camera).cast<double>();
  const double tan_y = std::tan(0.5 * view.camera.fov_y_rad), tan_x = tan_y * view.aspect;
  std::vector<Seen> seen;
  for (std::size_t n = 0; n < parts.size(); ++n) {
    const Ball& ball = parts[n].ball;
    const Vec3d centre = (T_view_model * ball.centre.homogeneous()).head<3>();
    if (!in_view(centre, ball.radius, tan_x, tan_y)) continue;
    const double depth = std::max(-centre.z() - ball.radius, 1.0);
    double px_per_mm = 0.5 * view.height_px / (depth * tan_y);
    if (view.focus && (ball.centre - view.focus->centre).norm() < ball.radius + view.focus->radius)
      px_per_mm /= kFocusShare;
    seen.push_back({n, depth, px_per_mm});
  }
  std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) {
    return a.depth_mm != b.depth_mm ? a.depth_mm < b.depth_mm : a.part < b.part;
  });
  return seen;
}

std::uint8_t level_for(double px_per_mm, double tolerance_px, std::uint8_t last) {
  std::size_t level = 0;
  while (level + 1 < kLevels && static_cast<double>(kCoarseCellMm[level]) * px_per_mm <= tolerance_px) ++level;
  const bool just = level > 0 && static_cast<double>(kCoarseCellMm[level - 1]) * px_per_mm > kKeep * tolerance_px;
  return static_cast<std::uint8_t>(just && last + 1U == level ? last : level);
}

}  // namespace

std::vector<DetailChoice> choose_detail(std::span<const DetailPart> parts, const DetailView& view, std::size_t budget) {
  const std::vector<Seen> seen = seen_parts(parts, view);
  std::vector<DetailChoice> out(seen.size());
  double tolerance_px = 0;  // first the mesh as it is
  for (int n = 0; n <= kTries; ++n) {
    std::size_t sum = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const DetailPart& part = parts[seen[i].part];
      out[i] = {seen[i].part, level_for(seen[i].px_per_mm, tolerance_px, part.last)};
      sum += part.triangles[out[i].level];
    }
    if (sum <= budget) break;
    tolerance_px = n == 0 ? kFinestPx : tolerance_px * kStep;
  }
  return out;
}

void DetailBudget::drawn(double frame_ms, std::size_t triangles) noexcept {
  constexpr double kShrink = 0.8, kGrow = 1.05;  // chosen: too slow is seen, too coarse hardly
  const bool is_slow = frame_ms > target_ms_, pixels_alone = is_slow && triangles <= kLeast;
  judge_pixels(frame_ms, pixels_alone);
  if (pixels_alone) return;  // not the triangles' fault
  auto wanted = static_cast<double>(triangles_);
  if (is_slow) {
    wanted = kShrink * static_cast<double>(std::min(triangles_, triangles));
  } else if (blur_ == 0 && frame_ms < kRoom * target_ms_ && 4 * triangles > 3 * triangles_) {
    wanted *= kGrow;
  }
  triangles_ = std::clamp(static_cast<std::size_t>(wanted), kLeast, kMost);
}

void DetailBudget::judge_pixels(double frame_ms, bool pixels_alone) noexcept {
  constexpr int kSlow = 3, kFast = 20;  // chosen: one frame beside other work changes nothing; no to and fro
  slow_ = pixels_alone ? slow_ + 1 : 0;
  if (slow_ >= kSlow && blur_ + 1 < kSharpness.size()) ++blur_, slow_ = 0;
  if (blur_ == 0) return;
  const double finer = kSharpness[blur_ - 1] / kSharpness[blur_];
  fast_ = frame_ms * finer * finer < kRoom * target_ms_ ? fast_ + 1 : 0;
  if (fast_ >= kFast) --blur_, fast_ = 0;
}

}  // namespace enamel::view
