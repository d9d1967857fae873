#include "pipeline/register/feature/rigid_ransac.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace enamel::pipeline {
namespace {

/// splitmix64: a draw is a function of its number alone.
std::uint64_t mix(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31U);
}

using Neighbours = std::vector<std::vector<std::uint32_t>>;

/// For each pair, the pairs at the same distance on both sides and far enough away to fix a rotation.
Neighbours compatible(const std::vector<PointPair>& pairs, const RansacConfig& config) {
  Neighbours out(pairs.size());
  for (std::uint32_t i = 0; i < pairs.size(); ++i) {
    for (std::uint32_t k = i + 1; k < pairs.size(); ++k) {
      const double from = (pairs[i].from - pairs[k].from).norm();
      const double to = (pairs[i].to - pairs[k].to).norm();
      if (from < config.min_side_mm || std::abs(from - to) > config.tolerance_mm) continue;
      out[i].push_back(k);
      out[k].push_back(i);
    }
  }
  return out;
}

/// Drops what agrees with too few others to be among min_inliers, keeps the most agreeing, in a total order.
std::vector<PointPair> most_compatible(const std::vector<PointPair>& pairs, const RansacConfig& config) {
  const Neighbours friends = compatible(pairs, config);
  std::vector<std::uint32_t> order(pairs.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return friends[a].size() != friends[b].size() ? friends[a].size() > friends[b].size() : a < b;
  });
  std::vector<PointPair> out;
  for (const std::uint32_t i : order) {
    if (static_cast<int>(out.size()) == config.max_pairs) break;
    if (static_cast<int>(friends[i].size()) < config.min_inliers / 2) break;
    out.push_back(pairs[i]);
  }
  return out;
}

/// Umeyama without scale. Sums in index order, so the result does not depend on a library's blocking.
Pose umeyama(const std::vector<PointPair>& pairs, std::span<const std::uint32_t> chosen) {
  Vec3d mean_from = Vec3d::Zero();
  Vec3d mean_to = Vec3d::Zero();
  for (const std::uint32_t i : chosen) {
    mean_from += pairs[i].from;
    mean_to += pairs[i].to;
  }
  mean_from /= static_cast<double>(chosen.size());
  mean_to /= static_cast<double>(chosen.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const std::uint32_t i : chosen) covariance += (pairs[i].to - mean_to) * (pairs[i].from - mean_from).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1.0 : 1.0;
  Pose T = Pose::Identity();
  T.linear() = svd.matrixU() * Vec3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
  T.translation() = mean_to - T.linear() * mean_from;
  return T;
}

std::vector<std::uint32_t> inliers_of(const std::vector<PointPair>& pairs, const Pose& T, double tolerance) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t i = 0; i < pairs.size(); ++i) {
    if ((T * pairs[i].from - pairs[i].to).squaredNorm() < tolerance * tolerance) out.push_back(i);
  }
  return out;
}

/// Three pairs that keep their distances, or nullopt for this draw.
std::optional<std::vector<std::uint32_t>> draw_triple(const std::vector<PointPair>& pairs, const Neighbours& friends,
                                                      std::uint64_t key, const RansacConfig& config) {
  const auto i = static_cast<std::uint32_t>(mix(key) % pairs.size());
  if (friends[i].size() < 2) return std::nullopt;
  const std::uint32_t k = friends[i][mix(key + 1) % friends[i].size()];
  const std::uint32_t l = friends[i][mix(key + 2) % friends[i].size()];
  if (!std::binary_search(friends[k].begin(), friends[k].end(), l)) return std::nullopt;
  const Vec3d a = pairs[k].from - pairs[i].from;
  const Vec3d b = pairs[l].from - pairs[i].from;
  // Nearly on one line: the rotation about it is free.
  if (a.cross(b).norm() < 0.3 * config.min_side_mm * std::max(a.norm(), b.norm())) return std::nullopt;
  return std::vector<std::uint32_t>{i, k, l};
}

}  // namespace

Pose best_rigid(const std::vector<PointPair>& pairs) {
  std::vector<std::uint32_t> all(pairs.size());
  std::iota(all.begin(), all.end(), 0U);
  return umeyama(pairs, all);
}

std::optional<RigidFit> fit_rigid(const std::vector<PointPair>& all, std::uint64_t seed, const RansacConfig& config) {
  const std::vector<PointPair> pairs = most_compatible(all, config);
  if (static_cast<int>(pairs.size()) < config.min_inliers) return std::nullopt;
  const Neighbours friends = compatible(pairs, config);
  std::vector<std::uint32_t> best;
  for (int draw = 0; draw < config.draws; ++draw) {
    const std::uint64_t key = mix(seed) + 4 * static_cast<std::uint64_t>(draw);
    const auto triple = draw_triple(pairs, friends, key, config);
    if (!triple) continue;
    auto inliers = inliers_of(pairs, umeyama(pairs, *triple), config.tolerance_mm);
    if (inliers.size() > best.size()) best = std::move(inliers);
  }
  RigidFit fit;
  for (int round = 0; round < 3; ++round) {
    if (static_cast<int>(best.size()) < config.min_inliers) return std::nullopt;
    fit.T_to_from = umeyama(pairs, best);
    best = inliers_of(pairs, fit.T_to_from, config.tolerance_mm);
  }
  if (static_cast<int>(best.size()) < config.min_inliers) return std::nullopt;
  double sum = 0;
  for (const std::uint32_t i : best) sum += (fit.T_to_from * pairs[i].from - pairs[i].to).squaredNorm();
  fit.inliers = static_cast<int>(best.size());
  fit.rms_mm = std::sqrt(sum / static_cast<double>(best.size()));
  return fit;
}

}  // namespace enamel::pipeline
