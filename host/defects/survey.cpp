#include "host/defects/survey.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "calib/model/lens.hpp"

namespace enamel::host {
namespace {

constexpr double kSteepestCos = 0.34;  // derived: cos 70 deg, beyond which nothing is fused
constexpr double kSamePlaceMm = 0.5;   // chosen: farther from the surface along its normal, it is another surface
constexpr double kGlareReachPx = 40;  // chosen: by judgement, from the middle of a glare to what was measured around it
constexpr double kFieldTan = 1.0;     // chosen: by judgement, wider than any camera of a probe looks

}  // namespace

Survey::Survey(const Mesh& mesh, const calib::LensValues& camera)
    : mesh_(mesh), cells_(cells_of(mesh)), camera_(camera), sums_(cells_.size()) {}

void Survey::measure(const SurfacePatch& patch, const Pose& T_model_cam, std::uint32_t cell, int u, int v) {
  const Vec3f& seen = patch.points(u, v);
  if (!std::isfinite(seen.z())) return;
  const std::uint32_t at = cells_.vertex[cell];
  const Vec3d n = mesh_.normals[at].cast<double>();
  const Vec3d p = mesh_.vertices[at].cast<double>();
  const double above = n.dot(T_model_cam * seen.cast<double>() - p);
  if (std::abs(above) > kSamePlaceMm) return;
  Sums& s = sums_[cell];
  const auto t = static_cast<double>(bursts_);
  s.n += 1;
  s.t += t;
  s.tt += t * t;
  s.r += above;
  s.rr += above * above;
  s.tr += t * above;
  s.best_cos = std::max(s.best_cos, n.dot((T_model_cam.translation() - p).normalized()));
}

void Survey::add(const SurfacePatch& patch, const Pose& T_model_cam, const Sight& sight) {
  const Pose T_cam_model = T_model_cam.inverse();
  double glare_px = sight.trouble == SightTrouble::kGlare ? kGlareReachPx : 0;
  std::optional<std::uint32_t> glare_cell;
  for (std::uint32_t c = 0; c < cells_.size(); ++c) {
    const Vec3d p = mesh_.vertices[cells_.vertex[c]].cast<double>();
    const Vec3d q = T_cam_model * p;
    if (q.z() <= 0 || std::abs(q.x()) > kFieldTan * q.z() || std::abs(q.y()) > kFieldTan * q.z()) continue;
    const Vec3d n = mesh_.normals[cells_.vertex[c]].cast<double>();
    if (n.dot((T_model_cam.translation() - p).normalized()) < kSteepestCos) continue;
    const calib::PlanePoint at = calib::project(camera_, {q.x() / q.z(), q.y() / q.z()});
    const int u = static_cast<int>(std::lround(at.x)), v = static_cast<int>(std::lround(at.y));
    if (!patch.points.contains(u, v)) continue;
    measure(patch, T_model_cam, c, u, v);
    const double off = std::hypot(at.x - static_cast<double>(sight.x_px), at.y - static_cast<double>(sight.y_px));
    if (off >= glare_px) continue;
    glare_px = off;
    glare_cell = c;
  }
  if (glare_cell) glare_cells_.push_back(*glare_cell);
  ++bursts_;
}

SurveyResult Survey::result() const {
  SurveyResult out;
  out.glare_cells = glare_cells_;
  for (const Sums& s : sums_) {
    CellFacts f;
    f.views = static_cast<std::uint32_t>(s.n);
    f.best_cos = static_cast<float>(s.best_cos);
    if (s.n > 2) {
      const double var_t = std::max(s.tt / s.n - s.t * s.t / (s.n * s.n), 0.0);
      const double var_r = std::max(s.rr / s.n - s.r * s.r / (s.n * s.n), 0.0);
      const double cov = s.tr / s.n - s.t * s.r / (s.n * s.n);
      const double sigma_t = std::sqrt(std::max(var_t, std::numeric_limits<double>::min()));
      f.scatter_mm = static_cast<float>(std::sqrt(var_r));
      f.drift_mm = static_cast<float>(2 * cov / sigma_t);
      const double left = std::max(var_r - cov * cov / (sigma_t * sigma_t), 0.0);
      f.drift_sigma_mm = static_cast<float>(2 * std::sqrt(left / s.n));
    }
    out.facts.push_back(f);
  }
  return out;
}

}  // namespace enamel::host
