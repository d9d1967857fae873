#include "calib/judge/judgement.hpp"

#include <fmt/format.h>

#include <cmath>

#include "calib/judge/prediction.hpp"

namespace enamel::calib {
namespace {

class Reasons {
 public:
  explicit Reasons(std::vector<std::string>& out) : out_(out) {}

  void limit(const char* what, double value, double most, const char* unit, const char* remedy) {
    if (!(value <= most))
      out_.push_back(fmt::format("{} {:.3g} {}, limit {:.3g}: {}", what, value, unit, most, remedy));
  }

 private:
  std::vector<std::string>& out_;
};

}  // namespace

Judgement judge(const Solution& solution, std::vector<PlaneCheck> planes, bool are_planes_held_out, DepthRange range,
                const JudgementLimits& limits) {
  Judgement j;
  const Prediction prediction(solution.state, solution.result.covariance, range);
  j.predicted = prediction.at(0.5);
  j.bound = prediction.at(kBoundQuantile);
  j.planes = std::move(planes);
  j.are_planes_held_out = are_planes_held_out;
  j.shapes = shapes_over_depth(j.planes, range);
  double squares = 0, noise = 0, points = 0;
  for (const PlaneCheck& p : j.planes) {
    squares += p.rms_um * p.rms_um * static_cast<double>(p.points);
    noise += p.noise_um * p.noise_um * static_cast<double>(p.points);
    points += static_cast<double>(p.points);
  }
  if (points > 0) {
    j.plane_rms_um = std::sqrt(squares / points);
    j.plane_noise_um = std::sqrt(noise / points);
    j.plane_unexplained_um = std::sqrt(std::max(0.0, squares - noise) / points);
  }
  Reasons reasons(j.reasons);
  const char* more = "more poses, tilted to all sides and over the whole depth";
  reasons.limit("camera reprojection rms", solution.result.rms_camera_px, limits.rms_camera_px, "px",
                "hold the target still, check that target.json is this target's");
  reasons.limit("projector reprojection rms", solution.result.rms_projector_px, limits.rms_projector_px, "px",
                "hold the target still during the fringes, linearise the projector");
  reasons.limit("expected error over the volume (95 %)", j.predicted.shape_p95_um, limits.p95_um, "um", more);
  if (!solution.is_shape_solved)
    reasons.limit("expected scale error", j.predicted.scale_ppm, limits.scale_ppm, "ppm", more);
  if (!j.planes.empty()) {
    reasons.limit("planes are seen uneven beyond their pixels' noise, rms", j.plane_unexplained_um, limits.plane_rms_um,
                  "um", "keep the target clean and still, linearise the projector; or the lens is not of this model");
  }
  for (const DepthShape& s : j.shapes) {
    const auto bow = [&](const char* what, double PlaneShape::*part) {
      const double beyond = std::max(0.0, std::abs(s.shape.*part) - 2 * (s.sigma.*part));
      reasons.limit(fmt::format("{} at {:.0f} mm is beyond doubt at least", what, s.depth_mm).c_str(), beyond,
                    limits.bow_um, "um over 16 mm",
                    "poses are missing at that depth, or the lens is not of this model");
    };
    bow("sag along x", &PlaneShape::sag_x_um);
    bow("sag along y", &PlaneShape::sag_y_um);
    bow("twist", &PlaneShape::twist_um);
  }
  j.is_accepted = j.reasons.empty();
  return j;
}

}  // namespace enamel::calib
