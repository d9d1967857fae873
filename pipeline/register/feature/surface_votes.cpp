#include "pipeline/register/feature/surface_votes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pipeline/register/feature/rigid_ransac.hpp"

namespace enamel::pipeline {
namespace {

/// A feature of the patch and one like it in the model.
struct Match {
  std::uint32_t patch = 0;
  int distance = 0;
  Vec3f from, from_normal;  ///< camera frame
  Vec3f to, to_normal;      ///< model frame
  Eigen::Matrix3f R;        ///< of the motion that it stands for
};

using Descriptor = std::array<std::uint8_t, 128>;

int half_distance2(const Descriptor& a, const Descriptor& b, std::size_t first) {
  int sum = 0;
  for (std::size_t i = first; i < first + 64; ++i) {
    const int d = static_cast<int>(a[i]) - static_cast<int>(b[i]);
    sum += d * d;
  }
  return sum;
}

/// Squared, or any number not below `limit` where it is not below that.
int distance2(const Descriptor& a, const Descriptor& b, int limit) {
  const int first = half_distance2(a, b, 0);
  return first >= limit ? first : first + half_distance2(a, b, 64);
}

/// The likes of one feature at distinct places, nearest first.
class Likes {
 public:
  Likes(std::size_t most, double same_place_mm)
      : most_(most), same2_(static_cast<float>(same_place_mm * same_place_mm)) {}
  [[nodiscard]] int worst() const { return found_.size() < most_ ? INT32_MAX : found_.back().distance; }
  [[nodiscard]] const std::vector<Match>& all() const { return found_; }
  void offer(const Match& match) {
    const auto same = std::find_if(found_.begin(), found_.end(),
                                   [&](const Match& m) { return (m.to - match.to).squaredNorm() < same2_; });
    if (same != found_.end()) {
      if (same->distance <= match.distance) return;
      found_.erase(same);
    }
    const auto at =
        std::find_if(found_.begin(), found_.end(), [&](const Match& m) { return m.distance > match.distance; });
    found_.insert(at, match);
    if (found_.size() > most_) found_.pop_back();
  }

 private:
  std::size_t most_;
  float same2_;
  std::vector<Match> found_;
};

std::vector<Match> match_all(const std::vector<SurfaceFeature>& patch, std::span<const KnownFeatures> known,
                             const VoteConfig& config) {
  std::vector<Match> out;
  for (std::uint32_t i = 0; i < patch.size(); ++i) {
    Likes likes(static_cast<std::size_t>(config.places_per_feature), config.same_place_mm);
    for (const KnownFeatures& frame : known) {
      const Eigen::Matrix3f R = frame.T_model_cam.linear().cast<float>();
      const Vec3f t = frame.T_model_cam.translation().cast<float>();
      for (const SurfaceFeature& f : frame.features) {
        if (f.convex != patch[i].convex) continue;
        const int distance = distance2(f.descriptor, patch[i].descriptor, likes.worst());
        if (distance >= likes.worst()) continue;
        likes.offer({i, distance, patch[i].point, patch[i].axes.col(2), R * f.point + t, R * f.axes.col(2),
                     R * f.axes * patch[i].axes.transpose()});
      }
    }
    out.insert(out.end(), likes.all().begin(), likes.all().end());
  }
  return out;
}

struct Tolerance {
  float mm2, cosine;
};

Tolerance tolerance(double mm, const VoteConfig& config) {
  return {static_cast<float>(mm * mm), static_cast<float>(std::cos(config.explained_deg * std::numbers::pi / 180))};
}

/// One match a feature of the patch, the nearest: what the motion explains. `matches` are in order of features.
std::vector<std::uint32_t> explained(const std::vector<Match>& matches, const Eigen::Matrix3f& R, const Vec3f& t,
                                     const Tolerance& within) {
  std::vector<std::uint32_t> out;
  float best = 0;
  for (std::uint32_t k = 0; k < matches.size(); ++k) {
    const Match& m = matches[k];
    const float d2 = (R * m.from + t - m.to).squaredNorm();
    if (!(d2 < within.mm2) || !((R * m.from_normal).dot(m.to_normal) > within.cosine)) continue;
    if (!out.empty() && matches[out.back()].patch == m.patch) {
      if (d2 < best) out.back() = k, best = d2;
      continue;
    }
    out.push_back(k);
    best = d2;
  }
  return out;
}

struct Refined {
  PlaceHypothesis place;
  std::vector<std::uint32_t> inliers;  ///< matches that it explains
};

Refined refine(const std::vector<Match>& matches, const Match& seed, const VoteConfig& config) {
  Eigen::Matrix3f R = seed.R;
  Vec3f t = seed.to - seed.R * seed.from;
  double reach = config.explained_mm;
  Refined out;
  for (int round = 0; round < 4; ++round) {
    out.inliers = explained(matches, R, t, tolerance(reach, config));
    out.place.support = static_cast<int>(out.inliers.size());
    if (out.place.support < config.min_support) return {};
    std::vector<PointPair> pairs;
    for (const std::uint32_t k : out.inliers) {
      pairs.push_back({matches[k].from.cast<double>(), matches[k].to.cast<double>()});
    }
    out.place.T_model_cam = best_rigid(pairs);
    R = out.place.T_model_cam.linear().cast<float>();
    t = out.place.T_model_cam.translation().cast<float>();
    reach = std::max(config.refined_mm, 0.7 * reach);
  }
  return out;
}

/// Matches in order of how many others the motion of each explains.
std::vector<std::uint32_t> by_support(const std::vector<Match>& matches, const VoteConfig& config) {
  std::vector<std::pair<int, std::uint32_t>> order;
  for (std::uint32_t k = 0; k < matches.size(); ++k) {
    const Match& m = matches[k];
    const auto support =
        static_cast<int>(explained(matches, m.R, m.to - m.R * m.from, tolerance(config.explained_mm, config)).size());
    if (support >= config.min_support) order.emplace_back(-support, k);
  }
  std::sort(order.begin(), order.end());
  std::vector<std::uint32_t> out;
  out.reserve(order.size());
  for (const auto& [support, k] : order) out.push_back(k);
  return out;
}

bool same_place(const Pose& a, const Pose& b, const Vec3d& centre, const VoteConfig& config) {
  const Eigen::AngleAxisd between(a.linear().transpose() * b.linear());
  return (a * centre - b * centre).norm() < config.apart_mm &&
         between.angle() < config.apart_deg * std::numbers::pi / 180;
}

}  // namespace

std::vector<PlaceHypothesis> vote_for_places(const std::vector<SurfaceFeature>& patch,
                                             std::span<const KnownFeatures> known, const VoteConfig& config) {
  const std::vector<Match> matches = match_all(patch, known, config);
  if (matches.empty()) return {};
  Vec3d centre = Vec3d::Zero();
  for (const SurfaceFeature& f : patch) centre += f.point.cast<double>() / static_cast<double>(patch.size());
  std::vector<PlaceHypothesis> out;
  std::vector<bool> used(matches.size(), false);
  int tried = 0;
  for (const std::uint32_t k : by_support(matches, config)) {
    if (used[k]) continue;  // else the first place would use up all tries and a rival stay unseen
    if (++tried > config.max_tries) break;
    const Refined refined = refine(matches, matches[k], config);
    if (refined.place.support < config.min_support) continue;
    for (const std::uint32_t i : refined.inliers) used[i] = true;
    const bool known_place = std::any_of(out.begin(), out.end(), [&](const PlaceHypothesis& other) {
      return same_place(other.T_model_cam, refined.place.T_model_cam, centre, config);
    });
    if (!known_place) out.push_back(refined.place);
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const PlaceHypothesis& a, const PlaceHypothesis& b) { return a.support > b.support; });
  if (out.size() > config.max_hypotheses) out.resize(config.max_hypotheses);
  while (out.size() > 1 && out.back().support < config.rival_share * out.front().support) out.pop_back();
  return out;
}

}  // namespace enamel::pipeline
