#include "host/desktop/desktop_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "protocol/base/json_text.hpp"

namespace enamel::host {
namespace {

using Json = nlohmann::json;

constexpr double kMicron = 1e3;  // in a millimetre

const char* name_of(pipeline::Laid laid) {
  switch (laid) {
    case pipeline::Laid::kLaid:
      return "laid";
    case pipeline::Laid::kAlone:
      return "alone";
    case pipeline::Laid::kNot:
      break;
  }
  return "not_laid";
}

const char* name_of(pipeline::Slip::Kind kind) {
  switch (kind) {
    case pipeline::Slip::Kind::kRotation:
      return "rotation";
    case pipeline::Slip::Kind::kSwing:
      return "swing";
    case pipeline::Slip::Kind::kModel:
      return "model";
    case pipeline::Slip::Kind::kTable:
      return "table";
    case pipeline::Slip::Kind::kOnce:
      break;
  }
  return "once";
}

/// Of the lines as fitted from those of the calibration, within a field's width of what was seen.
Json line_change(const calib::AxisLine& before, const calib::AxisLine& after, const calib::Triple& about) {
  constexpr double kReach_mm = 9;
  const calib::LineDifference d = calib::compare_lines(before, after, about, kReach_mm);
  return {{"direction_deg", d.angle_rad * calib::kDegreesPerRad}, {"place_um", kMicron * d.distance_mm}};
}

Json stops_json(const DesktopModel& model, const pipeline::LaidStops& laid) {
  Json out = Json::array();
  std::size_t n = 0;
  for (const MeasuredStop& stop : model.stops()) {
    const calib::AxisAngles& at = stop.angles;
    Json row{{"rotation_deg", at.rotation() * calib::kDegreesPerRad},
             {"swing_deg", at.swing() * calib::kDegreesPerRad},
             {"bursts", stop.bursts.size()},
             {"seen_px", stop.seen_px},
             {"table_px", stop.table_px}};
    if (stop.saw_model) {
      const pipeline::StopDeviation& by = laid.corrections[n];
      row["laid"] = name_of(laid.laid[n]);
      row["rotation_off_deg"] = by.rotation_rad * calib::kDegreesPerRad;
      row["swing_off_deg"] = by.swing_rad * calib::kDegreesPerRad;
      row["rest_um"] = kMicron * by.rest_mm;
      ++n;
    } else {
      row["laid"] = "saw_nothing";
    }
    out.push_back(std::move(row));
  }
  return out;
}

Json slips_json(const pipeline::LaidStops& laid) {
  Json out = Json::array();
  for (const pipeline::Slip& slip : laid.slips) {
    out.push_back({{"stop", slip.stop},
                   {"kind", name_of(slip.kind)},
                   {"rotation_deg", slip.rotation_deg},
                   {"swing_deg", slip.swing_deg},
                   {"rest_um", kMicron * slip.rest_mm},
                   {"text", slip.text()}});
  }
  return out;
}

Json circles_json(const pipeline::LaidStops& laid) {
  Json out = Json::array();
  for (const pipeline::Circle& c : laid.circles) {
    out.push_back({{"swing_deg", c.swing_deg},
                   {"stops", c.stops},
                   {"chain_um", kMicron * c.chain_mm},
                   {"chain_deg", c.chain_deg},
                   {"by_axes_um", kMicron * c.by_axes_mm},
                   {"after_um", kMicron * c.after_mm}});
  }
  return out;
}

Json plan_json(const PlanOutcome& plan) {
  return {{"kind", plan.is_automatic ? "auto" : "fixed"},
          {"ended", plan.ended},
          {"is_complete", plan.is_complete},
          {"share_seen", plan.share_seen ? Json(*plan.share_seen) : Json()}};
}

std::string why_incomplete(const PlanOutcome& plan) {
  if (plan.ended == "max_stops") return "as many stops as are allowed were taken, another would show more";
  if (plan.ended == "nothing_seen") return "no stop saw a model";
  return "stopped before the plan's end";
}

}  // namespace

std::string desktop_line(const pipeline::LaidStops& laid, const std::optional<PlanOutcome>& plan) {
  const auto left_out = std::ranges::count(laid.laid, pipeline::Laid::kNot);
  std::string out = fmt::format("{} laid{}; surfaces agree within {:.1f} um, by the axes alone {:.1f}",
                                laid.laid.size() - static_cast<std::size_t>(left_out),
                                left_out > 0 ? fmt::format(", {} left out", left_out) : std::string(),
                                kMicron * laid.fine_rms_mm, kMicron * laid.coarse_rms_mm);
  double worst_mm = -1;
  for (const pipeline::Circle& circle : laid.circles) worst_mm = std::max(worst_mm, circle.after_mm);
  if (worst_mm >= 0) out += fmt::format("; circle closes within {:.1f}", kMicron * worst_mm);
  return plan && !plan->is_complete ? out + "; not complete: " + why_incomplete(*plan) : out;
}

std::string desktop_json(const DesktopModel& model, const pipeline::LaidStops& laid, const DesktopSeconds& seconds,
                         const std::optional<PlanOutcome>& plan) {
  const calib::Triple about{0, 0, calib::middle_depth_mm(model.rig())};
  const Json out{{"stops", stops_json(model, laid)},
                 {"plan", plan ? plan_json(*plan) : Json()},
                 {"slips", slips_json(laid)},
                 {"pairs", laid.pairs},
                 {"edges", laid.edges},
                 {"switched_off", laid.switched_off},
                 {"sigma0", laid.sigma0},
                 {"by_axes_rms_um", kMicron * laid.coarse_rms_mm},
                 {"fine_rms_um", kMicron * laid.fine_rms_mm},
                 {"circles", circles_json(laid)},
                 {"mount",
                  {{"serial", model.mount().serial},
                   {"rotation_fitted", line_change(model.mount().rotation, laid.mount.rotation, about)},
                   {"swing_fitted", line_change(model.mount().swing, laid.mount.swing, about)}}},
                 {"seconds", {{"stops", seconds.stops}, {"laying", seconds.laying}}}};
  return json_text(out);
}

}  // namespace enamel::host
