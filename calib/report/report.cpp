#include "calib/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calib/report/coverage_plot.hpp"
#include "calib/report/residual_plot.hpp"
#include "calib/report/svg.hpp"
#include "protocol/base/xml.hpp"

namespace enamel::calib {
namespace {

std::string figure(const std::string& picture, const std::string& caption) {
  return "<figure>" + picture + "<figcaption>" + caption + "</figcaption></figure>\n";
}

std::string row(const std::vector<std::string>& cells, const char* tag = "td") {
  std::string out = "<tr>";
  for (const auto& cell : cells) out += fmt::format("<{0}>{1}</{0}>", tag, cell);
  return out + "</tr>\n";
}

ReportSection verdict(const ReportInput& in) {
  const Judgement& j = *in.judgement;
  const BundleResult& r = in.solution->result;
  std::string html = fmt::format("<p class=\"verdict {0}\">{0}</p>\n", j.is_accepted ? "accepted" : "refused");
  if (!j.reasons.empty()) {
    html += "<ul>";
    for (const auto& reason : j.reasons) html += "<li>" + xml_escaped(reason) + "</li>";
    html += "</ul>\n";
  }
  html += "<table class=\"facts\">";
  const auto fact = [&](const std::string& what, const std::string& value) { html += row({what, value}); };
  fact("probe", in.serial.empty() ? "-" : xml_escaped(in.serial));
  fact("pictures taken", in.calibrated_at.empty() ? "-" : xml_escaped(in.calibrated_at));
  fact("poses", fmt::format("{} used, {} rejected", in.solution->poses.size(), in.solution->rejected.size()));
  fact("reprojection, rms", fmt::format("camera {:.4f} px, projector {:.4f} px", r.rms_camera_px, r.rms_projector_px));
  fact("error to expect over the volume",
       fmt::format("{:.2f} µm (95 % of the points), at most {:.2f} µm; scale {:.0f} ppm", j.predicted.p95_um,
                   j.bound.p95_um, j.predicted.scale_ppm));
  fact("planes, rms", j.planes.empty() ? "none"
                                       : fmt::format("{:.2f} µm{}", j.plane_rms_um,
                                                     j.are_planes_held_out ? " on poses that were held out"
                                                                           : "; the same poses were solved with"));
  fact("shape of the target", in.solution->is_shape_solved ? "solved too" : "taken as drawn");
  fact("projector's response",
       in.response_residual ? fmt::format("off a straight line by {:.1f} % of full scale", 100 * *in.response_residual)
                            : "not measured");
  html += "</table>\n";
  if (!in.solution->notes.empty()) {
    html += "<ul class=\"notes\">";
    for (const auto& note : in.solution->notes) html += "<li>" + xml_escaped(note) + "</li>";
    html += "</ul>\n";
  }
  return {"Verdict", html};
}

ReportSection residuals(const ReportInput& in) {
  const Solution& s = *in.solution;
  std::vector<FieldArrow> camera, projector;
  for (const DotResidual& r : s.result.residuals) {
    const DotView& dot = s.poses[r.pose].dots[r.view];
    if (dot.is_outlier) continue;
    camera.push_back({dot.camera_px, r.camera_px});
    projector.push_back({dot.map.projector_px, r.projector_px});
  }
  const LensValues &c = s.state.camera, &p = s.state.projector;
  return {"Residuals over the field",
          figure(residual_field(camera, c.width, c.height),
                 fmt::format("Camera, rms {:.4f} px: centres of the dots, measured less predicted.",
                             s.result.rms_camera_px)) +
              figure(residual_field(projector, p.width, p.height),
                     fmt::format("Projector, rms {:.4f} px.", s.result.rms_projector_px)) +
              "<p>Grey: each dot. Dark: the mean of a cell. Means that point the same way side by side are not noise "
              "but something the model does not know.</p>"};
}

ReportSection coverage(const ReportInput& in) {
  return {"Coverage",
          figure(field_coverage(*in.solution, in.target, in.range), "Dots over the camera's field, by depth.") +
              figure(tilt_coverage(*in.solution, in.target, in.range),
                     "Tilts: which way and how far each pose leans. Wanted: all sides of the green ring.") +
              figure(depth_coverage(*in.solution, in.target, in.range),
                     "Depth from the nearest to the farthest dot of each pose; green is the measuring range.")};
}

ReportSection shapes(const ReportInput& in, double limit_um) {
  return {"Sag and twist over the depth",
          figure(shape_chart(*in.judgement, in.range, limit_um),
                 fmt::format("Heights over 16 mm in µm. Circles: single planes. Dots with bars: the judged values with "
                             "two standard errors. Green: within {:g} µm.",
                             limit_um))};
}

Result<ReportSection> planes(const ReportInput& in) {
  const Judgement& j = *in.judgement;
  const double limit_um = round_number(std::max(0.5, 1.2 * j.plane_rms_um));
  std::string html = "<div class=\"maps\">";
  for (const PlaneCheck& plane : j.planes) {
    ENAMEL_TRY_ASSIGN(const std::string map,
                      plane_map(plane, in.solution->state.camera.width, in.solution->state.camera.height, limit_um));
    html += figure(
        map, fmt::format("Pose {}, {:.1f} mm: rms {:.2f} µm, sag {:.2f}, twist {:.2f} µm", xml_escaped(plane.pose),
                         plane.depth_mm, plane.rms_um, plane.shape.sag_um(), plane.shape.twist_um));
  }
  html += fmt::format(
      "</div><p>The ground between the dots over its best plane, in the camera's image; means of 15 × 15 pixels. "
      "<span class=\"swatch\" style=\"background:rgb(33,102,172)\"></span> {0:g} µm nearer "
      "<span class=\"swatch\" style=\"background:rgb(178,24,43)\"></span> {0:g} µm farther.</p>",
      limit_um);
  return ReportSection{"Planes", j.planes.empty() ? "<p>No planes were judged.</p>" : html};
}

ReportSection steps(const ReportInput& in) {
  std::string html = "<table>" + row({"after", "planes, µm rms", "±", "95 %, µm", "sag or twist, µm", "±"}, "th");
  for (const StepEffect& s : in.steps) {
    html += row({xml_escaped(s.step), fmt::format("{:.4f}", s.plane_rms_um),
                 fmt::format("{:.4f}", s.plane_rms_sigma_um), fmt::format("{:.3f}", s.plane_p95_um),
                 fmt::format("{:.3f}", s.sag_um), fmt::format("{:.3f}", s.sag_sigma_um)});
  }
  return {"Effect of each step", html + "</table><p>On the judging planes; ± one standard error.</p>"};
}

ReportSection poses(const ReportInput& in) {
  std::string html =
      "<table>" +
      row({"pose", "", "depth, mm", "tilt, °", "dots", "left out", "camera, px", "projector, px", "plane, µm"}, "th");
  for (const PoseRow& p : pose_rows(*in.solution, in.target)) {
    const auto plane = std::find_if(in.judgement->planes.begin(), in.judgement->planes.end(),
                                    [&](const PlaneCheck& c) { return c.pose == p.pose; });
    html += row({xml_escaped(p.pose), "used", fmt::format("{:.1f}", p.depth_mm), fmt::format("{:.1f}", p.tilt_deg),
                 std::to_string(p.dots), std::to_string(p.outliers), fmt::format("{:.4f}", p.rms_camera_px),
                 fmt::format("{:.4f}", p.rms_projector_px),
                 plane == in.judgement->planes.end() ? "-" : fmt::format("{:.2f}", plane->rms_um)});
  }
  for (const PoseNote& note : in.solution->rejected) {
    html += fmt::format("<tr class=\"rejected\"><td>{}</td><td>rejected</td><td colspan=\"7\">{}</td></tr>\n",
                        xml_escaped(note.pose), xml_escaped(note.reason));
  }
  return {"Poses", html + "</table>"};
}

ReportSection parameters(const ReportInput& in) {
  std::string html = "<table>" + row({"parameter", "value", "sigma", ""}, "th");
  for (const RigParameter& p : rig_parameters(in.solution->state, in.solution->result.covariance))
    html += row({p.name, fmt::format("{:.6f}", p.value), p.sigma ? fmt::format("{:.2g}", *p.sigma) : "-", p.unit});
  return {"Parameters", html + "</table>"};
}

}  // namespace

std::vector<RigParameter> rig_parameters(const RigState& state, const Eigen::MatrixXd& covariance) {
  std::vector<double> values;
  for (const LensValues* l : {&state.camera, &state.projector})
    values.insert(values.end(), {l->fx, l->fy, l->cx, l->cy, l->dist[0], l->dist[1], l->dist[2], l->dist[3]});
  const Eigen::AngleAxisd turn(state.T_proj_cam.linear());
  const Vec3d w = turn.angle() * turn.axis(), t = state.T_proj_cam.translation();
  values.insert(values.end(), {w.x(), w.y(), w.z(), t.x(), t.y(), t.z()});
  constexpr std::size_t kLenses = 16, kTurn = 19;
  std::vector<RigParameter> out;
  const auto names = rig_parameter_names();
  for (std::size_t i = 0; i < names.size(); ++i) {
    RigParameter p{.name = names[i], .value = values[i], .sigma = {}, .unit = ""};
    p.unit = i >= kTurn ? "mm" : i >= kLenses ? "rad" : i % 8 < 4 ? "px" : "";
    const auto at = static_cast<Eigen::Index>(i);
    if (covariance.rows() == kRigParameters && covariance(at, at) >= 0) p.sigma = std::sqrt(covariance(at, at));
    out.push_back(std::move(p));
  }
  return out;
}

std::vector<PoseRow> pose_rows(const Solution& s, const TargetDesign& target) {
  std::vector<PoseRow> rows;
  for (std::size_t j = 0; j < s.poses.size(); ++j) {
    PoseRow r;
    r.pose = s.poses[j].name;
    r.dots = s.poses[j].dots.size();
    r.tilt_deg = tilt_deg(s.state.T_cam_target[j]);
    r.depth_mm = (s.state.T_cam_target[j] * target.place(target.size() / 2)).z();
    rows.push_back(std::move(r));
  }
  std::vector<double> used(rows.size());
  for (const DotResidual& r : s.result.residuals) {
    if (s.poses[r.pose].dots[r.view].is_outlier) {
      ++rows[r.pose].outliers;
      continue;
    }
    used[r.pose] += 1;
    rows[r.pose].rms_camera_px += r.camera_px.squaredNorm();
    rows[r.pose].rms_projector_px += r.projector_px.squaredNorm();
  }
  for (std::size_t j = 0; j < rows.size(); ++j) {
    rows[j].rms_camera_px = used[j] > 0 ? std::sqrt(rows[j].rms_camera_px / used[j]) : 0;
    rows[j].rms_projector_px = used[j] > 0 ? std::sqrt(rows[j].rms_projector_px / used[j]) : 0;
  }
  return rows;
}

Result<std::vector<ReportSection>> report_sections(const ReportInput& input) {
  ENAMEL_TRY_ASSIGN(ReportSection maps, planes(input));
  return std::vector<ReportSection>{
      verdict(input),  residuals(input), coverage(input), shapes(input, JudgementLimits{}.bow_um),
      std::move(maps), steps(input),     poses(input),    parameters(input)};
}

}  // namespace enamel::calib
