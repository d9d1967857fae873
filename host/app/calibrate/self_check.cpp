#include "host/app/calibrate/self_check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <utility>
#include <variant>
#include <vector>

#include "calib/judge/drift.hpp"
#include "calib/model/measuring_rig.hpp"
#include "host/app/input.hpp"
#include "host/record/burst_stream.hpp"
#include "host/session/replay_session.hpp"
#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/stages/burst_view.hpp"
#include "protocol/base/log.hpp"

namespace enamel::app {
namespace {

using Json = nlohmann::ordered_json;

Result<proto::Burst> first_burst(host::BurstStream& stream, const std::string& capture) {
  for (;;) {
    ENAMEL_TRY_ASSIGN(auto record, stream.next());
    if (!record) return fail(ErrorCode::kEmptyInput, capture);
    if (auto* burst = std::get_if<proto::Burst>(&record->value)) return std::move(*burst);
  }
}

/// Where the scan's bursts lie, by a lossless replay.
Result<std::vector<host::PlacedPose>> placed(const std::string& capture, const calib::Rig& optics, int workers) {
  SteadyClock clock;
  ENAMEL_TRY_ASSIGN(auto stream, host::open_bursts(capture));
  host::ReplayConfig config{.pipeline = {}, .workers = workers};
  config.pipeline.map.refine = false;  // poses as they were tracked: what an error of the rig does to them is the check
  ENAMEL_TRY_ASSIGN(const auto session, host::ReplaySession::create(std::move(stream), optics, config, clock));
  session->start();
  ENAMEL_TRY_ASSIGN(auto outcome, session->finish());
  return std::move(outcome.scan.poses);
}

/// Evenly spread over the scan, at most `count`.
std::vector<host::PlacedPose> spread(const std::vector<host::PlacedPose>& poses, std::size_t count) {
  if (poses.size() <= count) return poses;
  std::vector<host::PlacedPose> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(poses[i * poses.size() / count]);
  return out;
}

Result<std::vector<calib::DriftView>> views_of(const std::vector<host::PlacedPose>& poses, host::BurstStream& stream,
                                               const calib::Rig& optics) {
  ENAMEL_TRY_ASSIGN(const auto decoder, pipeline::BurstDecoder::make(optics));
  std::vector<calib::DriftView> views;
  pipeline::DecodeWorkspace workspace;
  pipeline::DecodedBurst decoded;
  for (const host::PlacedPose& pose : poses) {
    ENAMEL_TRY_ASSIGN(const proto::Burst burst, stream.burst_with_id(pose.id));
    if (!proto::is_consistent(burst)) continue;
    decoder.decode(stage::view_of(burst), workspace, decoded);
    if (decoded.accepted()) views.push_back(calib::drift_view(decoded.patch, pose.T_model_cam));
  }
  return views;
}

Json figures_json(const calib::DriftCheck& check) {
  Json out = Json::array();
  for (const calib::DriftFigure& f : check.figures) {
    out.push_back({{"name", f.name},
                   {"um", f.um},
                   {"sigma_um", f.sigma_um},
                   {"limit_um", f.limit_um},
                   {"smallest_seen_um", f.smallest_um},
                   {"alarm", f.is_alarm}});
  }
  return out;
}

/// The verdict in words and what to do about it.
void add_verdict(Json& json, const calib::DriftCheck& check) {
  json["reasons"] = Json::array();
  json["verdict"] = check.is_alarm() ? "alarm" : check.blind().empty() ? "ok" : "unclear";
  for (const calib::DriftFigure& f : check.figures) {
    if (f.is_alarm)
      json["reasons"].push_back(fmt::format("{} is off by {:.2f} +- {:.2f} um", f.name, f.um, f.sigma_um));
  }
  if (check.is_alarm()) {
    json["advice"] =
        "the overlaps of this scan contradict the calibration: let the probe warm up and scan again; if the alarm "
        "stays, calibrate anew (enamel calibrate capture, solve)";
  } else if (!check.blind().empty()) {
    json["reasons"].push_back(fmt::format("this scan says little about {}", fmt::join(check.blind(), ", ")));
    json["advice"] = "scan the same teeth from three sides, and once with the probe rolled by 90 degrees";
  }
}

}  // namespace

Result<Json> self_check(const calib::Rig& rig, const SelfCheckOptions& options) {
  namespace fs = std::filesystem;
  std::error_code ec;
  const fs::path inside = fs::path(options.capture) / "capture.mcap";
  const std::string capture = fs::is_regular_file(inside, ec) ? inside.string() : options.capture;
  ENAMEL_TRY_ASSIGN(const auto stream, host::open_bursts(capture));
  if (stream->rig_text().empty()) return fail(ErrorCode::kRigMissing, capture);
  ENAMEL_TRY_ASSIGN(const calib::Rig recorded, calib::parse_rig(stream->rig_text()));
  ENAMEL_TRY_ASSIGN(const calib::Rig calibration, calib::measuring_rig(rig, recorded));
  ENAMEL_TRY_ASSIGN(const proto::Burst first, first_burst(*stream, capture));
  const calib::Rig optics = calib::rig_at(calibration, first.temp_centi_c / 100.0);  // as a replay takes it
  ENAMEL_TRY_ASSIGN(const auto poses, placed(capture, optics, options.workers));
  log::info("calibrate", "{} bursts placed", poses.size());
  ENAMEL_TRY_ASSIGN(auto views, views_of(spread(poses, static_cast<std::size_t>(options.views)), *stream, optics));
  ENAMEL_TRY_ASSIGN(const calib::DriftCheck check, calib::check_drift(std::move(views), optics.camera));
  Json json;
  add_verdict(json, check);
  json["figures"] = figures_json(check);
  json["overlap_rms_um"] = {{"without_drift", check.rms_before_um}, {"with_drift", check.rms_after_um}};
  json["bursts_placed"] = poses.size();
  json["views"] = check.views;
  json["pairs"] = check.pairs;
  json["matches"] = check.matches;
  return json;
}

}  // namespace enamel::app
