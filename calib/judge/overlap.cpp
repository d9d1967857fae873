#include "calib/judge/overlap.hpp"

#include <cmath>

#include "calib/model/lens.hpp"

namespace enamel::calib {
namespace {

const Vec3d kPivot{0, 0, kDriftPivot_mm};
constexpr double kFloor_mm = 0.003;  // what decoding leaves on a cell beyond its noise

struct Corrected {
  Vec3d point;
  DriftVector shift;  ///< of the point along its ray, mm per theta: p(theta) = p + ray * shift . theta
};

Corrected corrected(const SurfaceCell& cell, const DriftVector& theta) {
  const Vec3d measured = cell.point.cast<double>();
  const Vec3d ray = measured / measured.z();
  const DriftVector basis = drift_basis(ray);
  const double z = 1 / (1 / measured.z() - basis.dot(theta)), around = cell.depth_around_mm;
  return {ray * z, basis * (around * around)};
}

/// Nothing measured, or alone.
bool is_empty(const SurfaceCell& cell) { return std::isnan(cell.point.z()) || std::isnan(cell.depth_around_mm); }

/// The cell of `view` that holds the picture of p; nullptr outside.
const SurfaceCell* cell_under(const DriftView& view, const LensValues& camera, const Vec3d& p) {
  if (!(p.z() > 1)) return nullptr;
  const PlanePoint pixel = project(camera, {p.x() / p.z(), p.y() / p.z()});
  const double u = std::floor((pixel.x + 0.5) / kDriftCell_px), v = std::floor((pixel.y + 0.5) / kDriftCell_px);
  if (!(u >= 0 && v >= 0 && u < view.cells.width() && v < view.cells.height())) return nullptr;
  const SurfaceCell& cell = view.cells(static_cast<int>(u), static_cast<int>(v));
  return is_empty(cell) ? nullptr : &cell;
}

}  // namespace

DriftVector drift_basis(const Vec3d& ray) {
  const double x = ray.x(), y = ray.y();
  return (DriftVector() << 1, x, y, x * y, x * x, y * y).finished();
}

PairSystem overlap(const DriftView& from, const DriftView& onto, const LensValues& camera, const DriftVector& theta,
                   const OverlapConfig& config) {
  PairSystem sum;
  const Pose T_onto_from = onto.T_model_cam.inverse() * from.T_model_cam;
  for (int v = 0; v < from.cells.height(); v += config.stride) {
    for (int u = 0; u < from.cells.width(); u += config.stride) {
      const SurfaceCell& cell = from.cells(u, v);
      if (is_empty(cell)) continue;
      const Corrected p = corrected(cell, theta);
      const Vec3d q = T_onto_from * p.point;
      const SurfaceCell* met = cell_under(onto, camera, q);
      if (met == nullptr) continue;
      const Vec3d turned = T_onto_from.linear() * cell.normal.cast<double>(), other = met->normal.cast<double>();
      if (turned.dot(other) < config.min_cosine) continue;
      // The mean of both normals: two points of a curved surface lie in no plane of either, but on a circle their chord
      // is at right angles to it (Rusinkiewicz 2019). One normal alone would flatten the relief by half a micron.
      const Vec3d n = (turned + other).normalized();
      const Vec3d n_from = T_onto_from.linear().transpose() * n;
      const Corrected s = corrected(*met, theta);
      const double e = n.dot(q - s.point);
      if (std::abs(e) > config.max_distance_mm) continue;

      Eigen::Matrix<double, kPairUnknowns, 1> J;
      J << (p.point - kPivot).cross(n_from), n_from, -(q - kPivot).cross(n), -n,
          p.shift * n_from.dot(p.point / p.point.z()) - s.shift * n.dot(s.point / s.point.z());
      const double variance = cell.sigma_mm * cell.sigma_mm + met->sigma_mm * met->sigma_mm + kFloor_mm * kFloor_mm;
      const double r = 3 * e / config.max_distance_mm;
      const double w = std::exp(-r * r) / variance;
      sum.H.noalias() += w * J * J.transpose();
      sum.g.noalias() += w * e * J;
      sum.weighted_squares += e * e / variance;
      sum.weight += 1 / variance;
      ++sum.matches;
    }
  }
  return sum;
}

}  // namespace enamel::calib
