// enamel calibrate capture: takes the pictures of a calibration from a live probe and guides the person who holds the
// target.
#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "calib/guide/coverage.hpp"
#include "calib/guide/coverage_picture.hpp"
#include "calib/guide/pose_writer.hpp"
#include "host/app/calibrate/pose_feed.hpp"
#include "host/app/calibrate/subcommand.hpp"
#include "host/app/link_options.hpp"
#include "host/app/run_options.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/base/log.hpp"

namespace enamel::app {

namespace {

using Json = nlohmann::ordered_json;

struct GatherOptions {
  std::string target, out, serial;
  dds::LinkChoice link;
  int poses = 10, sweeps = 4;
  double seconds = 0, wait_seconds = 15;
  bool json = false;
};

/// What the person at the target is told, pose by pose, and what is kept of it.
class Guide {
 public:
  Guide(const GatherOptions& o, calib::TargetDesign target, const ProbeSeen& probe, calib::PoseWriter writer)
      : probe_(probe),
        wanted_{.poses = o.poses},
        checker_(std::move(target), probe.rig, probe.noise, o.sweeps, probe.saturation_dn),
        writer_(std::move(writer)) {}

  /// Checks a pose, keeps it when it is good. Errors: kFileWrite.
  Result<void> take(const calib::PoseFrames& frames) {
    const calib::PoseCheck check = checker_.check(frames, accepted_);
    Json row{{"accepted", check.is_accepted()}, {"reasons", check.reasons}};
    if (!check.seen.dots_px.empty()) {
      row["depth_mm"] = check.seen.depth_mm;
      row["tilt_deg"] = check.seen.tilt_deg;
      row["azimuth_deg"] = check.seen.azimuth_deg;
      row["blur_px"] = check.seen.blur_px;
      row["saturated_pct"] = 100 * check.seen.saturated;
      row["dots"] = check.seen.dots_px.size();
    }
    rows_.push_back(std::move(row));
    if (!check.is_accepted()) {
      log::warn("calibrate", "pose refused: {}", fmt::join(check.reasons, "; "));
      return {};
    }
    ENAMEL_TRY(writer_.write(frames, probe_.rig.noise->bits));
    accepted_.push_back(check.seen);
    tell(check.seen);
    return calib::write_coverage_picture(accepted_, coverage(), probe_.rig, probe_.is_simulated,
                                         writer_.partial() + "/coverage.png");
  }

  void moved(int sweeps, int wanted) {
    rows_.push_back({{"accepted", false}, {"reasons", {fmt::format("moved after {} of {} sweeps", sweeps, wanted)}}});
    log::warn("calibrate", "pose refused: moved after {} of {} sweeps; hold still a little longer", sweeps, wanted);
  }

  [[nodiscard]] calib::Coverage coverage() const { return coverage_of(accepted_, probe_.rig, wanted_); }
  [[nodiscard]] bool has_poses() const { return static_cast<int>(accepted_.size()) >= wanted_.poses; }
  [[nodiscard]] std::size_t refused() const { return rows_.size() - accepted_.size(); }
  Result<void> commit(const std::string& target_text, int sweeps, std::optional<double> temp_c) {
    return writer_.commit(probe_.rig, target_text, sweeps, temp_c);
  }

  [[nodiscard]] Json json(const char* verdict) const {
    const calib::Coverage c = coverage();
    return {{"verdict", verdict},
            {"simulated", probe_.is_simulated},
            {"poses_accepted", c.poses},
            {"poses", rows_},
            {"coverage", {{"field_pct", 100 * c.field_share}, {"by_depth", c.by_depth}, {"by_side", c.by_side}}},
            {"missing", c.missing}};
  }

 private:
  void tell(const calib::SeenPose& seen) const {
    const calib::Coverage c = coverage();
    log::info("calibrate",
              "{}pose {:02} taken: {:.1f} mm, tilt {:.0f} deg, edges {:.2f} px, {:.1f} % at full scale; {}",
              probe_.is_simulated ? "SIMULATED: " : "", accepted_.size() - 1, seen.depth_mm, seen.tilt_deg,
              seen.blur_px, 100 * seen.saturated, c.is_enough() ? "enough" : "next: " + c.missing.front());
  }

  const ProbeSeen& probe_;
  calib::CoverageWanted wanted_;
  calib::PoseChecker checker_;
  calib::PoseWriter writer_;
  std::vector<calib::SeenPose> accepted_;
  std::vector<Json> rows_;
};

/// Takes poses until there are enough, the probe's session ends, or the person stops.
Result<void> gather(const GatherOptions& o, PoseFeed& feed, Guide& guide, Clock& clock) {
  const HostTime begin = clock.now();
  for (;;) {
    const bool ended = feed.ended();  // asked first: what came before the end is still taken
    while (auto news = feed.take()) {
      if (!news->frames) {
        guide.moved(news->sweeps, o.sweeps);
      } else {
        ENAMEL_TRY(guide.take(*news->frames));
      }
    }
    const bool is_over = o.seconds > 0 && std::chrono::duration<double>(clock.now() - begin).count() > o.seconds;
    if (ended || guide.coverage().is_enough() || is_over || stop_requested()) return {};
    clock.sleep_for(std::chrono::milliseconds(20));
  }
}

/// The folder, or the reason why there is none.
Result<int> conclude(const GatherOptions& o, Guide& guide, const PoseFeed& feed, const std::string& target_text) {
  const calib::Coverage coverage = guide.coverage();
  const char* verdict = coverage.is_enough() ? "complete" : guide.has_poses() ? "usable" : "refused";
  Json json = guide.json(verdict);
  json["broken_sweeps"] = feed.broken_sweeps();
  json["dropped_poses"] = feed.dropped_poses();
  if (feed.broken_sweeps() > 0)
    log::warn("calibrate", "{} sweeps dropped: bursts were lost on the way", feed.broken_sweeps());
  if (feed.dropped_poses() > 0)
    log::warn("calibrate", "{} poses dropped: this machine measures slower than they come", feed.dropped_poses());
  if (guide.has_poses()) ENAMEL_TRY(guide.commit(target_text, o.sweeps, feed.temp_c()));
  if (o.json) std::puts(json_text(json, 1).c_str());
  if (!guide.has_poses()) {
    std::string detail = fmt::format("{} of {} poses taken, {} refused", coverage.poses, o.poses, guide.refused());
    for (auto row = json["poses"].rbegin(); row != json["poses"].rend(); ++row) {
      if ((*row)["accepted"].get<bool>()) continue;
      detail += ", the last: " + (*row)["reasons"][0].get<std::string>();
      break;
    }
    if (json["poses"].empty()) detail += fmt::format("; the target never rested for {} sweeps", o.sweeps);
    return fail(ErrorCode::kCalibrationPoses, detail + "; " + o.out + " is not written");
  }
  for (const auto& what : coverage.missing) log::warn("calibrate", "would still help: {}", what);
  if (!o.json) {
    std::printf("%s%d poses -> %s\n", json["simulated"].get<bool>() ? "SIMULATED: " : "", coverage.poses,
                o.out.c_str());
  }
  return 0;
}

Result<int> run_capture(const GatherOptions& o) {
  SteadyClock clock;
  install_stop_signals();
  ENAMEL_TRY_ASSIGN(const std::string target_text, read_file(o.target));
  auto target = calib::parse_target(target_text);
  if (!target) return fail(target.error().code, o.target + ": " + target.error().detail);
  ENAMEL_TRY_ASSIGN(calib::PoseWriter writer, calib::PoseWriter::begin(o.out));
  ENAMEL_TRY_ASSIGN(const auto link, dds::participant_options(o.link, dds::LinkEnd::kHost));
  ENAMEL_TRY_ASSIGN(const auto participant, dds::Participant::create(link));
  ENAMEL_TRY_ASSIGN(
      const auto feed,
      PoseFeed::create(participant, {.serial = o.serial, .wait_seconds = o.wait_seconds, .sweeps = o.sweeps}, clock));
  while (!feed->probe() && !feed->ended() && !stop_requested()) clock.sleep_for(std::chrono::milliseconds(20));
  const auto probe = feed->probe();
  if (!probe)
    return tl::unexpected<Error>(feed->error().value_or(Error{ErrorCode::kCancelled, "before a probe was found"}));
  Guide guide(o, *target, *probe, std::move(writer));
  ENAMEL_TRY(gather(o, *feed, guide, clock));
  feed->stop();
  if (const auto error = feed->error(); error && !guide.has_poses()) return tl::unexpected<Error>(*error);
  return conclude(o, guide, *feed, target_text);
}

}  // namespace

CalibrateCommand add_calibrate_capture(CLI::App& app) {
  auto o = std::make_shared<GatherOptions>();
  CLI::App* capture = app.add_subcommand("capture", "pictures of a target from a live probe, pose by pose");
  capture->add_option("--target", o->target, "target.json of the board")->required();
  capture->add_option("--out", o->out, "calibration folder to write; nothing is written when the poses do not suffice")
      ->required();
  capture->add_option("--probe", o->serial, "serial of the probe; needed when there is more than one");
  capture->add_option("--poses", o->poses, "at least so many")->check(CLI::Range(3, 99))->capture_default_str();
  capture->add_option("--sweeps", o->sweeps, "times that all patterns are averaged at a pose")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  capture->add_option("--seconds", o->seconds, "end after this long")->check(CLI::PositiveNumber);
  capture->add_option("--wait-seconds", o->wait_seconds, "how long to wait for a probe")->capture_default_str();
  add_link_options(*capture, o->link);
  capture->add_flag("--json", o->json, "one JSON object on stdout");
  return {capture, [o]() -> Result<int> { return run_capture(*o); }};
}

}  // namespace enamel::app
