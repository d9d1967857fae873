#include "host/app/calibrate/camera.hpp"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "calib/solve/camera_alone.hpp"
#include "host/app/calibrate/verdict.hpp"
#include "protocol/base/clock.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/base/litter.hpp"

namespace enamel::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Pictures = std::vector<std::pair<std::string, std::string>>;

// A camera alone is no probe: corners of printed boards and pictures with a lossy codec pass that dots would not.
constexpr double kMaxRms_px = 0.5;

Pictures pictures_of(const CameraJob& job) {
  Pictures out;
  std::error_code ignored;
  const bool is_set = job.pictures.empty();
  for (const auto& entry : fs::directory_iterator(is_set ? job.folder + "/poses" : job.folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (is_litter_name(name)) continue;
    if (is_set && entry.is_directory(ignored)) out.emplace_back(name, (entry.path() / "white.png").string());
    if (!is_set && ::fnmatch(job.pictures.c_str(), name.c_str(), 0) == 0) out.emplace_back(name, entry.path().string());
  }
  std::sort(out.begin(), out.end());
  return out;
}

Json verdict_of(const calib::CameraSolution& s) {
  const double rms = s.start.rms_px;
  Json json{{"verdict", rms <= kMaxRms_px ? "accepted" : "refused"}, {"reasons", Json::array()}};
  if (rms > kMaxRms_px) {
    json["reasons"].push_back(
        fmt::format("camera reprojection rms {:.2f} px, limit {:.1f}: check the number of corners; is the board flat?",
                    rms, kMaxRms_px));
  }
  json["rms_camera_px"] = rms;
  json["poses_used"] = s.poses.size();
  json["poses_rejected"] = notes_json(s.rejected);
  const calib::LensValues& l = s.start.lens;
  json["camera"] = {{"width", l.width}, {"height", l.height}, {"fx", l.fx},    {"fy", l.fy},
                    {"cx", l.cx},       {"cy", l.cy},         {"dist", l.dist}};
  for (std::size_t j = 0; j < s.poses.size(); ++j)
    json["poses"].push_back({{"pose", s.poses[j]}, {"rms_camera_px", s.rms_px[j]}});
  json["start"] = s.start.method;
  return json;
}

void print(const Json& json) {
  std::printf("%s\n", json["verdict"].get<std::string>().c_str());
  for (const auto& reason : json["reasons"]) std::printf("  because %s\n", reason.get<std::string>().c_str());
  const Json& c = json["camera"];
  std::printf("camera             fx %.2f, fy %.2f, cx %.2f, cy %.2f px\n", c["fx"].get<double>(),
              c["fy"].get<double>(), c["cx"].get<double>(), c["cy"].get<double>());
  std::printf("reprojection rms   %.4f px over %d pictures\n", json["rms_camera_px"].get<double>(),
              json["poses_used"].get<int>());
  for (const auto& p : json["poses_rejected"]) {
    std::printf("picture %s left out: %s\n", p["pose"].get<std::string>().c_str(),
                p["reason"].get<std::string>().c_str());
  }
}

}  // namespace

Result<calib::TargetDesign> parse_board(const std::string& text) {
  int cols = 0, rows = 0, end = 0;
  double pitch = 0;
  if (std::sscanf(text.c_str(), "%dx%dx%lf%n", &cols, &rows, &pitch, &end) != 3 ||
      static_cast<std::size_t>(end) != text.size()) {
    return fail(ErrorCode::kUsage, "--chessboard " + text +
                                       ": write COLUMNSxROWSxSQUARE, e.g. 9x6x25 for 9 x 6 inner "
                                       "corners and squares of 25 mm");
  }
  const Json json{{"type", "chessboard"}, {"cols", cols}, {"rows", rows}, {"pitch_mm", pitch}};
  return calib::parse_target(json_text(json));
}

Result<calib::TargetDesign> board_of(const std::string& folder) {
  ENAMEL_TRY_ASSIGN(const std::string text, read_file(folder + "/target.json"));
  auto design = calib::parse_target(text);
  if (!design) return fail(design.error().code, folder + "/target.json: " + design.error().detail);
  return design;
}

bool is_camera_set(const std::string& folder) {
  const auto board = board_of(folder);
  if (!board || board->type != calib::TargetType::kChessboard) return false;
  std::error_code ignored;
  for (const auto& entry : fs::recursive_directory_iterator(folder + "/poses", ignored)) {
    const std::string name = entry.path().filename().string();
    if (::fnmatch("[vh]_*.png", name.c_str(), 0) == 0) return false;
  }
  return true;
}

Result<int> solve_camera_job(const CameraJob& job) {
  SteadyClock clock;
  const HostTime begin = clock.now();
  const Pictures pictures = pictures_of(job);
  if (pictures.empty()) {
    return fail(ErrorCode::kCalibrationFolder,
                job.folder + (job.pictures.empty() ? "/poses holds no pose" : ": no picture fits " + job.pictures));
  }
  ENAMEL_TRY_ASSIGN(const calib::CameraSolution solution, calib::solve_camera(pictures, job.board));
  Json json = verdict_of(solution);
  const bool is_accepted = json["verdict"] == "accepted";
  if (is_accepted) {
    const Json file{{"format", "camera/1"},
                    {"units", "px"},
                    {"camera", json["camera"]},
                    {"residuals", {{"rms_camera_px", json["rms_camera_px"]}, {"poses", json["poses_used"]}}}};
    ENAMEL_TRY(write_file(job.out, json_text(file, 1) + "\n"));
  }
  json["seconds"] = std::chrono::duration<double>(clock.now() - begin).count();
  job.json ? static_cast<void>(std::puts(json_text(json, 1).c_str())) : print(json);
  if (is_accepted) return 0;
  return fail(ErrorCode::kCalibrationRefused, job.out + " is not written");
}

}  // namespace enamel::app
