// A calibration as one self-contained HTML page: verdict, residual fields, coverage, planes, poses, parameters.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/judge/judgement.hpp"
#include "calib/judge/step_effect.hpp"

namespace enamel::calib {

/// One of the 22 parameters of bundle.hpp's order.
struct RigParameter {
  std::string name;
  double value = 0;
  std::optional<double> sigma;  ///< absent where the covariance says nothing
  const char* unit = "";
};

/// `covariance`: kRigParameters square, or anything else for unknown.
[[nodiscard]] std::vector<RigParameter> rig_parameters(const RigState& state, const Eigen::MatrixXd& covariance);

/// What a pose contributed, as far as it took part.
struct PoseRow {
  std::string pose;
  double depth_mm = 0;  ///< of the target's middle
  double tilt_deg = 0;
  std::size_t dots = 0, outliers = 0;
  double rms_camera_px = 0, rms_projector_px = 0;  ///< of the dots that took part
};
[[nodiscard]] std::vector<PoseRow> pose_rows(const Solution& solution, const TargetDesign& target);

struct ReportInput {
  std::string serial, calibrated_at;
  const Solution* solution = nullptr;
  const Judgement* judgement = nullptr;
  std::vector<StepEffect> steps;
  TargetDesign target;
  DepthRange range;
  std::optional<double> response_residual;
};

/// A part of the page: `html` goes into the page as it stands.
struct ReportSection {
  std::string title, html;
};

/// The sections in the order of the page; a caller may add its own before page_of.
/// Error: kInternal when a picture cannot be encoded.
[[nodiscard]] Result<std::vector<ReportSection>> report_sections(const ReportInput& input);

/// One HTML file that needs nothing beside it.
[[nodiscard]] std::string page_of(const std::string& title, const std::vector<ReportSection>& sections);

}  // namespace enamel::calib
