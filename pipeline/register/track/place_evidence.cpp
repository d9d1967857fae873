#include "pipeline/register/track/place_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace enamel::pipeline {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Moved {
  Eigen::Matrix3f R;
  Vec3f t;
  explicit Moved(const Pose& T) : R(T.linear().cast<float>()), t(T.translation().cast<float>()) {}
  [[nodiscard]] Vec3f operator()(const Vec3f& p) const { return R * p + t; }
};

/// Index of the view's pixel that a point in its camera's frame falls on, or -1.
std::ptrdiff_t pixel_of(const ModelView& view, const ViewCamera& camera, const Vec3f& p) {
  if (!(p.z() > 1.0F)) return -1;
  const Vec2f px = camera.project(p) / static_cast<float>(view.stride);
  const float u = std::floor(px.x() + 0.5F);
  const float v = std::floor(px.y() + 0.5F);
  if (!(u >= 0 && v >= 0 && u < static_cast<float>(view.points.width()) &&
        v < static_cast<float>(view.points.height()))) {
    return -1;
  }
  return static_cast<std::ptrdiff_t>(view.points.index(static_cast<int>(u), static_cast<int>(v)));
}

/// Neither at a silhouette nor beside a hole: its neighbours lie on the plane through it.
bool inner(const ModelView& view, std::size_t i, float layer) {
  const auto width = static_cast<std::size_t>(view.points.width());
  if (i < width || i + width >= view.points.size() || i % width == 0 || i % width == width - 1) return false;
  const Vec3f& p = view.points[i];
  const Vec3f& n = view.normals[i];
  const auto beside = [&](std::size_t k) { return std::abs(n.dot(view.points[k] - p)) < layer; };
  return beside(i - 1) && beside(i + 1) && beside(i - width) && beside(i + width);
}

enum class Meeting : std::uint8_t { kNothing, kMeets, kSeenThrough };

struct Verdict {
  Meeting meeting = Meeting::kNothing;
  float before_mm = 0;  ///< where it meets: in front of the other surface
};

/// One view's points before another view.
class Judge {
 public:
  Judge(const ModelView& view, const ViewCamera& camera, const EvidenceConfig& config)
      : view_(view),
        camera_(camera),
        match_(static_cast<float>(config.match_mm)),
        through_(static_cast<float>(config.through_mm)),
        cosine_(static_cast<float>(std::cos(config.match_deg * std::numbers::pi / 180))) {}

  /// p, n: in the frame that the view's points are in; at: p in the view's camera's frame.
  [[nodiscard]] Verdict operator()(const Vec3f& p, const Vec3f& n, const Vec3f& at) const {
    const std::ptrdiff_t pixel = pixel_of(view_, camera_, at);
    if (pixel < 0) return {};
    const auto i = static_cast<std::size_t>(pixel);
    const Vec3f& q = view_.points[i];
    if (!(q.x() == q.x())) return {};
    const Vec3f d = p - q;
    const float e = view_.normals[i].dot(d);
    if (std::abs(e) < match_ && d.squaredNorm() < 4 * match_ * match_ && view_.normals[i].dot(n) > cosine_) {
      return {Meeting::kMeets, e};
    }
    // Before the surface by its normal, not only along the ray: beside a steep wall the ray is a poor measure.
    return {e > through_ && inner(view_, i, through_) ? Meeting::kSeenThrough : Meeting::kNothing, 0};
  }

 private:
  const ModelView& view_;
  const ViewCamera& camera_;
  float match_, through_, cosine_;
};

}  // namespace

std::vector<std::size_t> keyframes_near(const std::vector<Keyframe>& keyframes, const Vec3d& point,
                                        double work_distance_mm, std::size_t most) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    const Vec3d seen = keyframes[k].T_model_cam * Vec3d(0, 0, work_distance_mm);
    order.emplace_back((seen - point).squaredNorm(), k);
  }
  std::sort(order.begin(), order.end());
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < std::min(most, order.size()); ++i) out.push_back(order[i].second);
  return out;
}

ModelView draw_keyframes(const std::vector<Keyframe>& keyframes, const std::vector<std::size_t>& chosen,
                         const DrawnFrom& from, const ViewCamera& camera, const EvidenceConfig& config) {
  ModelView out;
  out.T_model_cam = from.T_model_cam;
  if (chosen.empty()) return out;
  const ModelView& like = keyframes[chosen.front()].view;
  out.stride = std::max(from.stride, like.stride);
  const int width = like.points.width() * like.stride / out.stride;
  const int height = like.points.height() * like.stride / out.stride;
  out.points = Map<Vec3f>(width, height, Vec3f::Constant(kNan));
  out.normals = out.points;
  Map<float> depth(width, height, std::numeric_limits<float>::infinity());
  const Moved to_cam(from.T_model_cam.inverse());
  const auto layer = static_cast<float>(config.layer_mm);
  for (const std::size_t k : chosen) {
    const ModelView& view = keyframes[k].view;
    for (std::size_t i = 0; i < view.points.size(); ++i) {
      const Vec3f& p = view.points[i];
      if (!(p.x() == p.x())) continue;
      const Vec3f at = to_cam(p);
      const std::ptrdiff_t pixel = pixel_of(out, camera, at);
      if (pixel < 0 || !((to_cam.R * view.normals[i]).dot(at) < 0)) continue;
      const auto target = static_cast<std::size_t>(pixel);
      if (!(at.z() < depth[target] - (depth[target] < 1e6F ? layer : 0.0F))) continue;
      depth[target] = at.z();
      out.points[target] = p;
      out.normals[target] = view.normals[i];
      out.empty = false;
    }
  }
  return out;
}

namespace {

/// Of each pixel of the patch's view: whether it meets any keyframe's surface there.
Map<Verdict> ask_keyframes(const ModelView& patch, const Pose& T_model_cam, const std::vector<Keyframe>& keyframes,
                           const std::vector<std::size_t>& chosen, const ViewCamera& camera,
                           const EvidenceConfig& config) {
  const Moved to_model(T_model_cam);
  Map<Verdict> out(patch.points.width(), patch.points.height());
  for (const std::size_t k : chosen) {
    const Keyframe& frame = keyframes[k];
    const Judge judge(frame.view, camera, config);
    const Moved to_frame(frame.T_model_cam.inverse());
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (!(patch.points[i].x() == patch.points[i].x()) || out[i].meeting == Meeting::kMeets) continue;
      const Vec3f p = to_model(patch.points[i]);
      const Verdict verdict = judge(p, to_model.R * patch.normals[i], to_frame(p));
      if (verdict.meeting != Meeting::kNothing) out[i] = verdict;
    }
  }
  return out;
}

/// RMS of the blocks' mean distances. Blocks of which less than a quarter meets do not count.
double form_rms(const Map<Verdict>& verdicts, int block) {
  double sum2 = 0;
  int blocks = 0;
  for (int v0 = 0; v0 + block <= verdicts.height(); v0 += block) {
    for (int u0 = 0; u0 + block <= verdicts.width(); u0 += block) {
      double sum = 0;
      int count = 0;
      for (int k = 0; k < block * block; ++k) {
        const Verdict& verdict = verdicts(u0 + k % block, v0 + k / block);
        if (verdict.meeting != Meeting::kMeets) continue;
        sum += static_cast<double>(verdict.before_mm);
        ++count;
      }
      if (4 * count < block * block) continue;
      sum2 += sum * sum / (count * count);
      ++blocks;
    }
  }
  return blocks > 0 ? std::sqrt(sum2 / blocks) : 0;
}

/// What the keyframes show, drawn from the patch's place so that it counts once, that lies before the patch's surface.
std::size_t seen_through_by_patch(const ModelView& patch, const ModelView& drawn, const ViewCamera& camera,
                                  const EvidenceConfig& config) {
  const Judge judge(patch, camera, config);
  const Moved to_patch(drawn.T_model_cam.inverse());
  const auto layer = static_cast<float>(config.layer_mm);
  std::size_t out = 0;
  for (std::size_t i = 0; i < drawn.points.size(); ++i) {
    if (!(drawn.points[i].x() == drawn.points[i].x()) || !inner(drawn, i, layer)) continue;
    const Vec3f at = to_patch(drawn.points[i]);
    out += judge(at, to_patch.R * drawn.normals[i], at).meeting == Meeting::kSeenThrough ? 1U : 0U;
  }
  return out;
}

}  // namespace

PlaceEvidence weigh_place(const ModelView& patch, const Pose& T_model_cam, const std::vector<Keyframe>& keyframes,
                          const std::vector<std::size_t>& chosen, const ViewCamera& camera,
                          const EvidenceConfig& config) {
  const Map<Verdict> verdicts = ask_keyframes(patch, T_model_cam, keyframes, chosen, camera, config);
  const ModelView drawn = draw_keyframes(keyframes, chosen, {T_model_cam, patch.stride}, camera, config);
  const auto layer = static_cast<float>(config.layer_mm);
  std::size_t points = 0;
  std::size_t matches = 0;
  std::size_t seen_through = seen_through_by_patch(patch, drawn, camera, config);
  PlaceEvidence out;
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    points += patch.points[i].x() == patch.points[i].x() ? 1U : 0U;
    matches += verdicts[i].meeting == Meeting::kMeets ? 1U : 0U;
    seen_through += verdicts[i].meeting == Meeting::kSeenThrough && inner(patch, i, layer) ? 1U : 0U;
  }
  out.form_rms_mm =
      form_rms(verdicts, std::max(2, static_cast<int>(std::lround(config.block_mm / config.draw_pitch_mm))));
  if (points > 0) out.overlap = static_cast<double>(matches) / static_cast<double>(points);
  if (matches > 0) out.consistency = static_cast<double>(matches) / static_cast<double>(matches + seen_through);
  out.area_mm2 = static_cast<double>(matches) * config.draw_pitch_mm * config.draw_pitch_mm;
  return out;
}

bool convincing(const PlaceEvidence& evidence, double median_sigma_mm, const EvidenceConfig& config) {
  const double per_block = config.block_mm / config.draw_pitch_mm;
  const double block_noise = median_sigma_mm * std::sqrt(2.0) / (0.5 * per_block);
  return evidence.area_mm2 >= config.min_area_mm2 && evidence.consistency >= config.min_consistency &&
         evidence.form_rms_mm <= std::hypot(config.max_form_mm, block_noise);
}

}  // namespace enamel::pipeline
