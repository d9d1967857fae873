#include "pipeline/register/map/bow_edge.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "pipeline/register/icp/accumulate.hpp"
#include "pipeline/register/map/graph_terms.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kMotionAndBow = 6 + kBowTerms;
using Row9 = Eigen::Matrix<double, kMotionAndBow, 1>;
using Matrix9 = Eigen::Matrix<double, kMotionAndBow, kMotionAndBow>;

/// One sample on its pixel of the reference, by motion and bow.
struct Residual {
  Row9 J = Row9::Zero();
  double e = 0, weight = 0;
};

struct Pair {
  const MapNode& i;
  const MapNode& j;
  const MapEdge& edge;
  const ViewCamera camera;
  const BowField field;
  double rho_mm, gate_mm, min_cos;
};

/// As ICP associates: the pixel of j that the sample falls on, the distance along the mean of both normals.
bool residual_of(const Pair& of, std::size_t n, Residual& out) {
  const SampleSet& s = of.i.samples;
  const Vec3d p_i(s.x[n], s.y[n], s.z[n]);
  const Vec3d p = of.edge.T_j_i * p_i;
  if (p.z() <= 1) return false;
  const Vec2f at = of.camera.project(p.cast<float>()) * of.j.reference.pixels_per_camera_pixel();
  const auto u = static_cast<int>(std::floor(at.x() + 0.5F)), v = static_cast<int>(std::floor(at.y() + 0.5F));
  if (u < 0 || v < 0 || u >= of.j.reference.width() || v >= of.j.reference.height()) return false;
  const Reference::Pixel& pixel = of.j.reference.pixel(
      static_cast<std::size_t>(v) * static_cast<std::size_t>(of.j.reference.width()) + static_cast<std::size_t>(u));
  if (!std::isfinite(pixel.point.x())) return false;
  const Vec3d q = pixel.point.cast<double>();
  const Vec3d own = of.edge.T_j_i.linear() * Vec3d(s.nx[n], s.ny[n], s.nz[n]);
  const Vec3d facing = pixel.normal.cast<double>();
  const Vec3d normal = 0.5 * (facing + own);
  out.e = normal.dot(p - q);
  if (std::abs(out.e) >= of.gate_mm || (p - q).norm() > of.gate_mm + 0.1 || facing.dot(own) < of.min_cos) return false;
  const BowShifts apart = of.edge.T_j_i.linear() * of.field.shifts(p_i) - of.field.shifts(q);
  out.J << (p - of.edge.centre).cross(normal) / of.rho_mm, normal, -apart.transpose() * normal;
  out.weight = s.weights[n];
  return true;
}

/// H and its gradient of all samples; those that would not fit after the step `taken` are weighed less.
struct System {
  Matrix9 H = Matrix9::Zero();
  Row9 g = Row9::Zero();
  double weight = 0;
};
System sum_up(const std::vector<Residual>& residuals, const Row9& taken, const IcpConfig& icp) {
  std::vector<double> sizes;
  sizes.reserve(residuals.size());
  for (const Residual& r : residuals) sizes.push_back(std::abs(r.e + r.J.dot(taken)));
  const double scale = std::max(1.4826 * middle_of(std::move(sizes)), icp.samples.sigma_floor_mm);
  const RobustKernel kernel{true, static_cast<float>(1 / (icp.welsch_scale * scale))};
  System out;
  for (const Residual& r : residuals) {
    const double w = r.weight * static_cast<double>(kernel.weight(static_cast<float>(r.e + r.J.dot(taken))));
    out.H.noalias() += w * r.J * r.J.transpose();
    out.g += w * r.e * r.J;
    out.weight += w;
  }
  return out;
}

/// The step that lays both surfaces on each other, the bow held by what it may be.
Row9 step_of(const System& sums, double expected_mm) {
  Matrix9 H = sums.H;
  for (int k = 0; k < kMotionAndBow; ++k) H(k, k) += 1 / (expected_mm * expected_mm);
  return -H.ldlt().solve(sums.g);
}

/// Inverse over the directions that the surface holds.
Matrix6 inverse_where_held(const Matrix6& H, double weak_eigenvalue) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(H);
  Matrix6 out = Matrix6::Zero();
  for (int k = 0; k < 6; ++k) {
    if (eigen.eigenvalues()[k] < weak_eigenvalue * H.trace() / 2) continue;
    const Vector6 v = eigen.eigenvectors().col(k);
    out += v * v.transpose() / eigen.eigenvalues()[k];
  }
  return out;
}

}  // namespace

EdgeBow measure_edge_bow(const MapNode& i, const MapNode& j, const MapEdge& edge, const BowMeasuring& with) {
  const Pair pair{i,
                  j,
                  edge,
                  ViewCamera(with.rig.camera),
                  BowField(with.rig),
                  with.icp.rho_mm,
                  with.edge.gate_mm,
                  std::cos(with.edge.max_normal_deg * std::numbers::pi / 180)};
  std::vector<Residual> residuals;
  Residual r;
  for (std::size_t n = 0; n < i.samples.size(); n += with.bow.every) {
    if (residual_of(pair, n, r)) residuals.push_back(r);
  }
  EdgeBow out;
  if (residuals.empty()) return out;
  // Weighed by what a bow leaves, not by the bow: noise that adds to it would count less than noise against it, and the
  // bow come out 5 % too small.
  const Row9 step = step_of(sum_up(residuals, Row9::Zero(), with.icp), with.bow.expected_mm);
  const System sums = sum_up(residuals, step, with.icp);
  const Matrix6 inverse = inverse_where_held(sums.H.topLeftCorner<6, 6>(), with.icp.prior.weak_eigenvalue);
  const auto cross = sums.H.topRightCorner<6, kBowTerms>();
  out.motion = -inverse * cross;
  // What alignments have in common is no noise: all points of a pair together tell a bend no better than the bias.
  const double share = 1 / (1 + with.bow.bias_mm * with.bow.bias_mm * sums.weight);
  out.H = share * (sums.H.bottomRightCorner<kBowTerms, kBowTerms>() + cross.transpose() * out.motion);
  out.g = -share * (sums.g.tail<kBowTerms>() + out.motion.transpose() * sums.g.head<6>());
  return out;
}

}  // namespace enamel::pipeline
