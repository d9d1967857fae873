#include "pipeline/decode/motion/rigid_motion.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "pipeline/decode/motion/chosen.hpp"
#include "pipeline/decode/motion/motion_rows.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kUnknowns = 7;  ///< layout: V, W, and what all pixels share
using Vector7 = Eigen::Matrix<double, kUnknowns, 1>;
using Matrix7 = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using Theta = std::array<double, kUnknowns>;

/// One pass over the burst, with the slopes that the errors known so far leave.
class Pass {
 public:
  Pass(MotionView& view, const MovingSurface& surface, const RigidMotionConfig& config, RigidMotionWork& work)
      : view_(view), maps_(surface.maps), wraps_(surface.wraps), rays_(surface.rays), config_(config), work_(work) {}

  std::optional<Theta> run(const MotionField* known) {
    view_.take_samples(known, work_.samples);
    view_.make_images(known, work_.images);
    find_nodes(work_.images, maps_, wraps_, rays_, work_.nodes);
    take_columns(work_.nodes, work_.samples, work_.columns);
    return solve_robustly();
  }

  /// Motion at every node; one without slope takes the coarse rate of its block.
  void spread(const Theta& theta, MotionField& field) const {
    const MotionNodes& nodes = work_.nodes;
    const std::size_t count = nodes.count();
    field.columns = nodes.columns;
    field.detail = 1;
    field.rows = nodes.rows;
    field.rate_rad.resize(count);
    field.light.resize(count);
    field.shared = static_cast<float>(theta[6]);
    for (std::size_t n = 0; n < count; ++n) {
      float rate = 0, light = 0;
      for (std::size_t k = 0; k < 6; ++k) {
        rate += nodes.rate[k * count + n] * static_cast<float>(theta[k]);
        light += nodes.light[k * count + n] * static_cast<float>(theta[k]);
      }
      const int column = static_cast<int>(n) % nodes.columns, row = static_cast<int>(n) / nodes.columns;
      field.rate_rad[n] = nodes.has_slope(n) ? rate : rate_without_slope(theta, column, row);
      field.light[n] = std::clamp(light, -kMostGrowth, kMostGrowth);
    }
    spread_changes(theta, field);
  }

 private:
  /// That of the block; where it does not tell, of a surface that faces the camera in the middle of the range.
  [[nodiscard]] float rate_without_slope(const Theta& theta, int column, int row) const {
    const float of_block = view_.block_rate(column * kNode_px, row * kNode_px);
    if (of_block == of_block) return of_block;
    const std::size_t i = pixel_of_node(maps_, column, row);
    const float q = rays_.c0[i], x = rays_.rays.x[i] / q, y = rays_.rays.y[i] / q;
    const float away =
        static_cast<float>(theta[2]) + static_cast<float>(theta[3]) * y - static_cast<float>(theta[4]) * x;
    return -q * q * away / rays_.c1[i];
  }

  /// Rate and light are properties of the surface, and pass by with it: d/dt = -(image motion).grad.
  void spread_changes(const Theta& theta, MotionField& field) const {
    const MotionNodes& nodes = work_.nodes;
    field.rate_change_rad.assign(nodes.count(), 0.0F);
    field.light_change.assign(nodes.count(), 0.0F);
    const Eigen::Vector3f shift(static_cast<float>(theta[0]), static_cast<float>(theta[1]),
                                static_cast<float>(theta[2]));
    const Eigen::Vector3f turn(static_cast<float>(theta[3]), static_cast<float>(theta[4]),
                               static_cast<float>(theta[5]));
    const Eigen::Vector3f pivot_mm(0, 0, pivot_depth_mm(rays_));
    const auto pitch = static_cast<std::size_t>(nodes.columns);
    for (int row = 0; row < nodes.rows; ++row) {
      const float* inverse_depth = work_.images.inverse_depth.around(row, 0, 0);
      for (int column = 0; column < nodes.columns; ++column) {
        const std::size_t n = static_cast<std::size_t>(row) * pitch + static_cast<std::size_t>(column);
        const float q = inverse_depth[column];
        if (!nodes.has_slope(n) || !(q > 0)) continue;
        const std::size_t i = pixel_of_node(maps_, column, row);
        const auto width = static_cast<std::size_t>(maps_.phase_rad.width());
        const float x = rays_.rays.x[i], y = rays_.rays.y[i];
        const Eigen::Vector3f u = q * shift + turn.cross(Eigen::Vector3f(x, y, 1) - q * pivot_mm);
        const float per_px = 1 / static_cast<float>(kNode_px);
        const float right = per_px * (u.x() - x * u.z()) / (rays_.rays.x[i + 1] - x);
        const float down = per_px * (u.y() - y * u.z()) / (rays_.rays.y[i + width] - y);
        const auto passing = [&](const std::vector<float>& f) {
          return -right * step(f, n, 1, column, nodes.columns) - down * step(f, n, pitch, row, nodes.rows);
        };
        field.rate_change_rad[n] = passing(field.rate_rad);
        field.light_change[n] = passing(field.light) + field.light[n] * field.light[n];
      }
    }
  }

  /// Change of f from node to node along an axis, node n being the at-th of `count`: central; one-sided where one
  /// neighbour has no slope.
  [[nodiscard]] float step(const std::vector<float>& f, std::size_t n, std::size_t pitch, int at, int count) const {
    const bool before = at > 0 && work_.nodes.has_slope(n - pitch);
    const bool after = at + 1 < count && work_.nodes.has_slope(n + pitch);
    if (before && after) return 0.5F * (f[n + pitch] - f[n - pitch]);
    return (after ? f[n + pitch] : f[n]) - (before ? f[n - pitch] : f[n]);
  }

  [[nodiscard]] Theta solve(const MotionEquations& e) const {
    Matrix7 left;
    Vector7 right, spread;
    for (int row = 0; row < kUnknowns; ++row) {
      right[row] = e.right[static_cast<std::size_t>(row)];
      for (int column = row; column < kUnknowns; ++column)
        left(row, column) = left(column, row) = e.left[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
    }
    spread << Eigen::Vector3d::Constant(config_.shift_prior_mm), Eigen::Vector3d::Constant(config_.turn_prior_rad),
        config_.shared_prior;
    left.diagonal() +=
        static_cast<double>(kNodePixels) * e.squares / std::max(e.pixels, 1.0) * spread.cwiseInverse().cwiseAbs2();
    const Vector7 theta = left.ldlt().solve(right);
    Theta out{};
    std::copy_n(theta.data(), kUnknowns, out.begin());
    return out;
  }

  [[nodiscard]] std::optional<Theta> solve_robustly() const {
    Theta theta{};
    double limit = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kMotionRounds; ++round) {
      MotionEquations e;
      add_samples(work_.samples, work_.columns, theta, limit, e);
      if (e.pixels < static_cast<double>(config_.min_pixels)) return std::nullopt;
      theta = solve(e);
      limit = static_cast<double>(config_.outlier_sigmas) * std::sqrt(e.squares / e.pixels);
    }
    return theta;
  }

  MotionView& view_;
  const PhaseMaps& maps_;
  const Map<std::int16_t>& wraps_;
  const RayDepth& rays_;
  const RigidMotionConfig& config_;
  RigidMotionWork& work_;
};

}  // namespace

bool stands_still(std::span<const float> block_motion_rad, std::span<const float> block_sigma_rad,
                  float negligible_rad) {
  // derived: noise alone takes 5 % of the blocks so far, and a quarter of them is asked for.
  constexpr float kSignificantSigmas = 2;
  std::size_t seen = 0, moving = 0;
  for (std::size_t k = 0; k < block_motion_rad.size(); ++k) {
    if (!(block_sigma_rad[k] < kInformed_rad)) continue;
    ++seen;
    const float limit = negligible_rad + kSignificantSigmas * block_sigma_rad[k];
    moving += std::abs(block_motion_rad[k]) > limit ? 1U : 0U;
  }
  return seen > 0 && 4 * moving < seen;
}

RigidMotion fit_rigid_motion(MotionView& view, const MovingSurface& surface, const RigidMotionConfig& config,
                             RigidMotionWork& work, MotionField& field) {
  RigidMotion out;
  Pass pass(view, surface, config, work);
  for (int k = 0; k < config.passes; ++k) {
    const auto theta = pass.run(out.moved ? &field : nullptr);
    if (!theta) return {};
    pass.spread(*theta, field);
    std::copy_n(theta->begin(), 3, out.shift_mm.begin());
    std::copy_n(theta->begin() + 3, 3, out.turn_rad.begin());
    out.about_mm = static_cast<double>(pivot_depth_mm(surface.rays));
    out.moved = true;
  }
  return out;
}

}  // namespace enamel::pipeline
