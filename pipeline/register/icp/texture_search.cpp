#include "pipeline/register/icp/texture_search.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace enamel::pipeline {
namespace {

constexpr std::size_t kPointsLookedAt = 1200;  // of the blurred picture: a node's worth of a quarter millimetre each

/// Weak motions that shift the middle of the surface, by a millimetre each: two at most, for it slides on itself.
std::vector<Vector6> slides(const WeakDirections& weak) {
  constexpr double kLeastShift = 0.5;  // of a weak motion that is a slide and no spin about its own middle
  const Eigen::MatrixXd shift = weak.bottomRows<3>();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(shift, Eigen::ComputeThinU | Eigen::ComputeThinV);
  std::vector<Vector6> out;
  for (Eigen::Index i = 0; i < std::min<Eigen::Index>(svd.singularValues().size(), 2); ++i) {
    const double value = svd.singularValues()[i];
    if (value > kLeastShift) out.emplace_back(weak * svd.matrixV().col(i) / value);
  }
  return out;
}

struct Node {
  Vector6 x;
  double agreement;
};

}  // namespace

std::vector<Vector6> texture_candidates(const Sliding& sliding, const Pose& T_model_cam, const TextureConfig& config) {
  const std::vector<Vector6> along = slides(sliding.weak);
  if (along.empty()) return {};
  const std::size_t stride = std::max<std::size_t>(1, sliding.points.p.size() / kPointsLookedAt);
  const int reach = static_cast<int>(std::lround(config.search_mm / config.search_step_mm));
  std::vector<Node> nodes;
  for (int i = -reach; i <= reach; ++i) {
    const int wide = along.size() > 1 ? static_cast<int>(std::sqrt(reach * reach - i * i)) : 0;
    for (int j = -wide; j <= wide; ++j) {
      Vector6 x = config.search_step_mm * i * along[0];
      if (along.size() > 1) x += config.search_step_mm * j * along[1];
      const Pose at = apply_motion(x, sliding.of.centre, sliding.of.rho_mm, T_model_cam);
      nodes.push_back({x, blurred_agreement(sliding, at, stride, config.min_points / stride)});
    }
  }
  // The order of equals is that of the grid.
  std::ranges::stable_sort(nodes, [](const Node& a, const Node& b) { return a.agreement > b.agreement; });
  std::vector<Vector6> out;
  for (const Node& node : nodes) {
    const bool beside = std::ranges::any_of(
        out, [&](const Vector6& taken) { return (taken - node.x).norm() < 1.5 * config.search_step_mm; });
    if (!beside) out.push_back(node.x);
    if (out.size() == config.search_tries) break;
  }
  return out;
}

}  // namespace enamel::pipeline
