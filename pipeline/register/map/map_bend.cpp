#include "pipeline/register/map/map_bend.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace enamel::pipeline {
namespace {

constexpr float kStepMm = 0.5F;  // of slopes: half of a block

}  // namespace

MapBend::MapBend(const std::vector<KeyframeMove>& moves, double work_distance_mm, const BendConfig& config)
    : work_distance_mm_(work_distance_mm), config_(config) {
  const Vec3d work(0, 0, work_distance_mm);
  moved_.reserve(moves.size());
  for (const KeyframeMove& one : moves) {
    const Vec3d at = one.tracked * work;
    const Eigen::Matrix3d turn = one.mapped.linear() * one.tracked.linear().transpose();
    moved_.push_back(
        {at.cast<float>(), (one.mapped * work - at).cast<float>(), (turn - Eigen::Matrix3d::Identity()).cast<float>()});
  }
}

MapBend::Shift MapBend::around(const Vec3f& p) const {
  if (moved_.empty()) return {p};
  const auto apart = [&](const Moved& one) { return (one.at - p).squaredNorm(); };
  const auto reach = static_cast<float>(config_.reach_mm * config_.reach_mm);
  std::vector<Moved> near;
  std::ranges::copy_if(moved_, std::back_inserter(near), [&](const Moved& one) { return apart(one) < reach; });
  if (near.empty()) near.push_back(*std::ranges::min_element(moved_, {}, apart));
  Shift out{p, shift(near, p)};
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3f step = kStepMm * Vec3f::Unit(axis);
    out.slope.col(axis) = (shift(near, p + step) - shift(near, p - step)) / (2 * kStepMm);
  }
  return out;
}

Vec3f MapBend::shift(const std::vector<Moved>& near, const Vec3f& p) const {
  const auto inverse_variance = static_cast<float>(1 / (config_.sigma_mm * config_.sigma_mm));
  // Weights beside the largest: far from all keyframes none of them would count.
  float nearest = (near.front().at - p).squaredNorm();
  for (const Moved& one : near) nearest = std::min(nearest, (one.at - p).squaredNorm());
  Vec3f sum = Vec3f::Zero();
  float weights = 0;
  for (const Moved& one : near) {
    const Vec3f arm = p - one.at;
    const float w = std::exp(-0.5F * (arm.squaredNorm() - nearest) * inverse_variance);
    sum += w * (one.turn * arm + one.shift);
    weights += w;
  }
  return sum / weights;
}

Pose MapBend::carry(const Pose& T_model_cam) const {
  const Vec3f at = (T_model_cam * Vec3d(0, 0, work_distance_mm_)).cast<float>();
  // Not turned: microradians are not seen.
  return Eigen::Translation3d(around(at).there.cast<double>()) * T_model_cam;
}

}  // namespace enamel::pipeline
