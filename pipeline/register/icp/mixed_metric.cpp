#include "pipeline/register/icp/mixed_metric.hpp"

#include <numbers>

namespace enamel::pipeline {
namespace {

bool usable(const Reference& reference, int u, int v) {
  const auto i =
      static_cast<std::size_t>(v) * static_cast<std::size_t>(reference.width()) + static_cast<std::size_t>(u);
  return std::isfinite(reference.pixel(i).point.x());
}

/// Sums of the point term: J = ((p - c) x e_k / rho, e_k) of the three axes e_k at once.
class PointSums {
 public:
  /// lever: (p - c) / rho.
  void add(const Vec3d& lever, const Vec3d& e, double w) {
    weight_ += w;
    lever_ += w * lever;
    outer_ += w * lever * lever.transpose();
    residual_ += w * e;
    moment_ += w * lever.cross(e);
  }
  void add_to(NormalSystem& out) const {
    Eigen::Matrix3d cross;
    cross << 0, -lever_.z(), lever_.y(), lever_.z(), 0, -lever_.x(), -lever_.y(), lever_.x(), 0;
    out.H.topLeftCorner<3, 3>() += outer_.trace() * Eigen::Matrix3d::Identity() - outer_;
    out.H.topRightCorner<3, 3>() += cross;
    out.H.bottomLeftCorner<3, 3>() += cross.transpose();
    out.H.bottomRightCorner<3, 3>() += weight_ * Eigen::Matrix3d::Identity();
    out.g.head<3>() += moment_;
    out.g.tail<3>() += residual_;
    out.weight += weight_;
  }

 private:
  double weight_ = 0;
  Vec3d lever_ = Vec3d::Zero();
  Eigen::Matrix3d outer_ = Eigen::Matrix3d::Zero();
  Vec3d residual_ = Vec3d::Zero();
  Vec3d moment_ = Vec3d::Zero();
};

}  // namespace

struct ClosestPoints::Search {
  int u, v;  ///< pixel that the point falls on
  Vec3f point;
  float best_mm2;
  std::int32_t found = kNone;
};

ClosestPoints::ClosestPoints(const Reference& reference, const ViewCamera& camera, const MatchConfig& config)
    : reference_(reference), camera_(camera), config_(config) {
  rim_.reserve(static_cast<std::size_t>(reference.width()) * static_cast<std::size_t>(reference.height()));
  for (int v = 0; v < reference.height(); ++v) {
    for (int u = 0; u < reference.width(); ++u) rim_.push_back(on_rim(u, v) ? 1 : 0);
  }
}

bool ClosestPoints::on_rim(int u, int v) const {
  if (u < 1 || v < 1 || u + 1 >= reference_.width() || v + 1 >= reference_.height()) return true;
  for (int k = 0; k < 9; ++k) {
    if (!usable(reference_, u + k % 3 - 1, v + k / 3 - 1)) return true;
  }
  return false;
}

void ClosestPoints::look_at_ring(int radius, Search& search) const {
  const int width = reference_.width();
  for (int v = std::max(search.v - radius, 0); v <= std::min(search.v + radius, reference_.height() - 1); ++v) {
    const bool whole_row = std::abs(v - search.v) == radius;
    const int step = whole_row || radius == 0 ? 1 : 2 * radius;
    for (int u = search.u - radius; u <= search.u + radius; u += step) {
      if (u < 0 || u >= width) continue;
      const std::int32_t i = v * width + u;
      // NaN is never smaller.
      const float d2 = (reference_.pixel(static_cast<std::size_t>(i)).point - search.point).squaredNorm();
      if (!(d2 < search.best_mm2)) continue;
      search.best_mm2 = d2;
      search.found = i;
    }
  }
}

ClosestPoints::Match ClosestPoints::match(const Vec3f& in_view, const Vec3f& in_model, float reach_mm) const {
  Match out;
  if (!(in_view.z() > 1.0F)) return out;
  const float scale = reference_.pixels_per_camera_pixel();
  const Vec2f px = camera_.project(in_view);
  const float u = px.x() * scale + 0.5F, v = px.y() * scale + 0.5F;
  if (!(u >= 0 && v >= 0 && u < static_cast<float>(reference_.width()) &&
        v < static_cast<float>(reference_.height()))) {
    return out;
  }
  Search search{static_cast<int>(u), static_cast<int>(v), in_model, reach_mm * reach_mm};
  out.on_ray = search.v * reference_.width() + search.u;
  // Pixels a millimetre at the point's depth, the smaller of both ways.
  const Vec2f beside = camera_.project(in_view + Vec3f(1, 1, 0)) - px;
  const float px_per_mm = scale * std::min(beside.x(), beside.y());
  const float secant = in_view.norm() / in_view.z();
  for (int radius = 0; radius <= (config_.closest ? std::max(reference_.width(), reference_.height()) : 0); ++radius) {
    // The rays of this ring and all beyond pass the point at no less than this, whatever depth they end at.
    const float beyond_px = static_cast<float>(radius) - 0.5F;
    const float far_secant = secant + std::numbers::sqrt2_v<float> * (beyond_px + 1.0F) / (px_per_mm * in_view.z());
    const float nearest_mm = beyond_px / (px_per_mm * far_secant);
    if (radius > 0 && nearest_mm * nearest_mm >= search.best_mm2) break;
    look_at_ring(radius, search);
  }
  if (search.found != kNone && (config_.rim || rim_[static_cast<std::size_t>(search.found)] == 0)) {
    out.pixel = search.found;
  }
  return out;
}

namespace {

/// A sample that found nothing, or nothing that agrees: told from one that fell beside the reference.
bool contradicts(const Reference& reference, std::int32_t on_ray, const Vec3f& p, const MatchGate& gate) {
  if (on_ray == ClosestPoints::kNone) return false;
  const Vec3f& there = reference.pixel(static_cast<std::size_t>(on_ray)).point;
  if (!std::isfinite(there.x())) return false;
  const Vec3f axis = reference.T_model_cam().linear().col(2).cast<float>();
  const float behind = axis.dot(p - there);
  return behind <= gate.hidden_mm && std::abs(behind) > gate.distance_mm;
}

}  // namespace

AlignPass accumulate_mixed(const Alignment& of, const MixedTerm& term, const Pose& T_model_cam, const MatchGate& gate,
                           const RobustKernel& kernel) {
  const SampleSet& s = of.samples;
  const Eigen::Isometry3f to_model = T_model_cam.cast<float>();
  const Eigen::Isometry3f to_view = (of.reference.T_model_cam().inverse() * T_model_cam).cast<float>();
  const Vec3f centre = (T_model_cam * s.centroid).cast<float>();
  const double mu = 1 - term.lambda;
  AlignPass pass;
  PointSums points;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Vec3f sample(s.x[i], s.y[i], s.z[i]);
    const Vec3f p = to_model * sample;
    const auto [found, on_ray] = term.closest.match(to_view * sample, p, gate.distance3d_mm);
    if (found == ClosestPoints::kNone) {
      pass.contradictions += contradicts(of.reference, on_ray, p, gate) ? 1U : 0U;
      continue;
    }
    const Reference::Pixel& pixel = of.reference.pixel(static_cast<std::size_t>(found));
    const Vec3f own = to_model.linear() * Vec3f(s.nx[i], s.ny[i], s.nz[i]);
    const Vec3f d = p - pixel.point;
    const float e = 0.5F * (pixel.normal + own).dot(d);  // between both normals, as accumulate() says why
    if (!(std::abs(e) < gate.distance_mm) || pixel.normal.dot(own) < gate.min_cos) {
      ++pass.contradictions;
      continue;
    }
    const double w = static_cast<double>(s.weights[i]);
    const double robust = w * static_cast<double>(kernel.weight(e));
    const Vec3d lever = (p - centre).cast<double>() / of.rho_mm;
    const Vec3d normal = pixel.normal.cast<double>();
    Vector6 J;
    J << lever.cross(normal), normal;
    pass.system.add(J, static_cast<double>(e), term.lambda * robust);
    if (mu > 0) points.add(lever, d.cast<double>(), mu * robust);
    pass.residuals.add(std::abs(e));
    const double e2 = static_cast<double>(e) * static_cast<double>(e);
    pass.weight += w;
    pass.weighted_e2 += w * (term.lambda * e2 + mu * static_cast<double>(d.squaredNorm()));
    ++pass.matches;
  }
  points.add_to(pass.system);
  return pass;
}

}  // namespace enamel::pipeline
