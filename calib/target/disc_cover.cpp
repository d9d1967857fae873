#include "calib/target/disc_cover.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "calib/target/edge_spread.hpp"

namespace enamel::calib {
namespace {

constexpr double kGentle_px = 0.04;  // side² / radius of an arc that passes for its parabola: eight times its sagitta
constexpr int kMaxPieces = 4;

/// Radius of curvature at the longer axis' end: shorter² / longer.
double sharpest_radius_px(const Ellipse& e) {
  const Eigen::Vector2d half = e.half_axes();
  return half.y() * half.y() / half.x();
}

}  // namespace

double inside_px(const Ellipse& e, const Eigen::Vector2d& p) {
  const Eigen::Vector2d q = p - e.centre, mq = e.shape * q;
  const double f = std::sqrt(std::max(q.dot(mq), 1e-12));
  return (1 - f) * f / std::max(mq.norm(), 1e-9);
}

DiscCover::DiscCover(EdgeModel model, const PixelWindow& window, const Ellipse& start)
    : model_(model),
      pieces_(std::clamp(static_cast<int>(std::ceil(std::sqrt(1 / (kGentle_px * sharpest_radius_px(start))))), 1,
                         kMaxPieces)),
      u0_(window.u0 - kMaxTaps),
      v0_(window.v0 - kMaxTaps),
      sharp_(window.u1 - window.u0 + 1 + 2 * kMaxTaps, window.v1 - window.v0 + 1 + 2 * kMaxTaps),
      seen_(sharp_.width(), sharp_.height()) {}

CoverJet DiscCover::pixel(const Ellipse& e, const Eigen::Vector2d& p, double blur_px) const {
  CoverJet out;
  const double share = 1.0 / (pieces_ * pieces_), side = 1.0 / pieces_, bends = e.shape.determinant();
  for (int j = 0; j < pieces_; ++j) {
    for (int i = 0; i < pieces_; ++i) {
      const Eigen::Vector2d q = p - e.centre + Eigen::Vector2d(side * (i + 0.5) - 0.5, side * (j + 0.5) - 0.5);
      const Eigen::Vector2d mq = e.shape * q;
      const double f = std::sqrt(std::max(q.dot(mq), 1e-12)), n = std::max(mq.norm(), 1e-9);
      const double curvature = bends * f * f / (n * n * n);  // of the level curve through q
      const EdgeSpread edge = edge_spread((1 - f) * f / n, mq / n, blur_px, curvature, side);
      out.cover += share * edge.cover;
      const double slope = share * edge.by_distance / n;
      out.slope[0] += slope * mq.x();
      out.slope[1] += slope * mq.y();
      out.slope[2] -= 0.5 * slope * q.x() * q.x();
      out.slope[3] -= slope * q.x() * q.y();
      out.slope[4] -= 0.5 * slope * q.y() * q.y();
      out.slope[5] += share * edge.by_blur;
    }
  }
  return out;
}

void DiscCover::render(const Ellipse& e, double blur_px) {
  const bool is_lens = model_ == EdgeModel::kLensThenPixel;
  Map<CoverJet>& out = is_lens ? seen_ : sharp_;
  const double blur = is_lens ? blur_px : 0;
  const double reach_px = 1 + 6 * blur;
  for (int v = 0; v < out.height(); ++v) {
    for (int u = 0; u < out.width(); ++u) {
      const Eigen::Vector2d p(u0_ + u, v0_ + v);
      const double inside = inside_px(e, p);
      out(u, v) = CoverJet{inside > 0 ? 1.0 : 0.0};
      if (std::abs(inside) < reach_px) out(u, v) = pixel(e, p, blur);
    }
  }
  if (!is_lens) blur_with_taps(e, blur_px);
}

void DiscCover::blur_with_taps(const Ellipse& e, double blur_px) {
  const GaussianTaps taps(blur_px);
  const double reach_px = 1 + std::numbers::sqrt2 * taps.reach;
  for (int v = kMaxTaps; v < seen_.height() - kMaxTaps; ++v) {
    for (int u = kMaxTaps; u < seen_.width() - kMaxTaps; ++u) {
      CoverJet& out = seen_(u, v);
      out = sharp_(u, v);
      if (std::abs(inside_px(e, Eigen::Vector2d(u0_ + u, v0_ + v))) > reach_px) continue;
      out = {};
      for (int j = -taps.reach; j <= taps.reach; ++j) {
        for (int i = -taps.reach; i <= taps.reach; ++i) {
          const CoverJet& in = sharp_(u + i, v + j);
          const double weight = taps.weight_at(i) * taps.weight_at(j);
          out.cover += weight * in.cover;
          out.slope.head<5>() += weight * in.slope.head<5>();
          out.slope[5] += (taps.slope_at(i) * taps.weight_at(j) + taps.weight_at(i) * taps.slope_at(j)) * in.cover;
        }
      }
    }
  }
}

}  // namespace enamel::calib
