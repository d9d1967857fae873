#include "host/app/calibrate/outcome.hpp"

#include "calib/io/rig_writer.hpp"
#include "calib/report/report.hpp"
#include "host/app/calibrate/set.hpp"
#include "host/app/calibrate/verdict.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"

namespace enamel::app {
namespace {

using Json = nlohmann::ordered_json;

Json poses_json(const calib::Solution& solution, const calib::TargetDesign& target) {
  Json out = Json::array();
  for (const calib::PoseRow& p : calib::pose_rows(solution, target)) {
    out.push_back({{"pose", p.pose},
                   {"depth_mm", p.depth_mm},
                   {"tilt_deg", p.tilt_deg},
                   {"dots", p.dots},
                   {"left_out", p.outliers},
                   {"rms_camera_px", p.rms_camera_px},
                   {"rms_projector_px", p.rms_projector_px}});
  }
  return out;
}

/// One row a dot: pose, dot, camera u v and residual, projector u v and residual, 1 when it was left out.
Json residuals_json(const calib::Solution& s) {
  Json rows = Json::array();
  for (const calib::DotResidual& r : s.result.residuals) {
    const calib::DotView& dot = s.poses[r.pose].dots[r.view];
    const Eigen::Vector2d &c = dot.camera_px, &p = dot.map.projector_px;
    rows.push_back({s.poses[r.pose].name, dot.dot, c.x(), c.y(), r.camera_px.x(), r.camera_px.y(), p.x(), p.y(),
                    r.projector_px.x(), r.projector_px.y(), dot.is_outlier ? 1 : 0});
  }
  return {{"columns",
           {"pose", "dot", "camera_u", "camera_v", "camera_du", "camera_dv", "projector_u", "projector_v",
            "projector_du", "projector_dv", "left_out"}},
          {"rows", rows}};
}

}  // namespace

Result<std::string> rig_text(const Outcome& o) {
  const calib::Solution& s = o.solution;
  calib::SolvedRig solved{.camera = s.state.camera,
                          .projector = s.state.projector,
                          .T_proj_cam = s.state.T_proj_cam,
                          .parameter_names = {},
                          .covariance = s.result.covariance,
                          .calibrated_at = calib::capture_time_utc(o.folder.path),
                          .response = o.measured.response,
                          .correction = s.state.correction,
                          .temp_c = o.folder.nominal.temp_c,
                          .temperature = std::nullopt,
                          .rms_camera_px = s.result.rms_camera_px,
                          .rms_projector_px = s.result.rms_projector_px,
                          .poses = static_cast<int>(s.poses.size()),
                          .is_shape_solved = s.is_shape_solved};
  for (const char* name : calib::rig_parameter_names()) solved.parameter_names.emplace_back(name);
  return calib::solved_rig_text(o.folder.nominal, solved);
}

Result<void> write_report(const Outcome& o, Json verdict, const std::string& stem) {
  calib::ReportInput input;
  input.serial = o.folder.nominal.serial;
  input.calibrated_at = calib::capture_time_utc(o.folder.path);
  input.solution = &o.solution;
  input.judgement = &o.judgement;
  input.steps = o.steps;
  input.target = o.folder.target;
  input.range = range_of(o.folder.nominal);
  if (o.measured.response) input.response_residual = o.measured.response->residual;
  ENAMEL_TRY_ASSIGN(const auto sections, calib::report_sections(input));
  const std::string title = "Calibration" + (input.serial.empty() ? "" : " of probe " + input.serial);
  ENAMEL_TRY(write_file(stem + ".html", calib::page_of(title, sections)));
  verdict["poses"] = poses_json(o.solution, o.folder.target);
  verdict["parameters"] = parameters_json(calib::rig_parameters(o.solution.state, o.solution.result.covariance));
  verdict["residuals"] = residuals_json(o.solution);
  return write_file(stem + ".json", json_text(verdict, 1) + "\n");
}

}  // namespace enamel::app
