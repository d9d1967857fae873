#include "tools/twin/app/calibration_folder.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "protocol/base/file.hpp"
#include "tools/twin/board/board_stage.hpp"
#include "tools/twin/board/nominal_rig.hpp"
#include "tools/twin/mount/mount_files.hpp"
#include "tools/twin/truth_files.hpp"

namespace enamel::twin {
namespace {

namespace fs = std::filesystem;

struct Picture {
  std::string path;
  std::vector<float> dn;
};

Result<std::string> encode(const Picture& picture, const SensorConfig& sensor, int width, int height) {
  const bool is_wide = sensor.bits > 8;
  const double top = std::ldexp(1.0, sensor.bits) - 1;
  cv::Mat image(height, width, is_wide ? CV_16UC1 : CV_8UC1);
  for (std::size_t i = 0; i < picture.dn.size(); ++i) {
    const double value = std::clamp(std::nearbyint(static_cast<double>(picture.dn[i])), 0.0, top);
    if (is_wide) {
      image.ptr<std::uint16_t>()[i] = static_cast<std::uint16_t>(value);
    } else {
      image.ptr<std::uint8_t>()[i] = static_cast<std::uint8_t>(value);
    }
  }
  std::vector<unsigned char> bytes;
  try {
    cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
  } catch (const cv::Exception& e) {
    return fail(ErrorCode::kInternal, e.what());
  }
  return std::string(bytes.begin(), bytes.end());
}

/// Every picture once: frames 2 and 3 of set 0 repeat white and black.
std::vector<Picture> pose_pictures(const BoardStage& stage, std::size_t stand, const FrameAverager& averager,
                                   const SceneConfig& scene, const std::string& folder) {
  std::vector<Picture> pictures;
  const StillView view = stage.trace(stand);
  const auto sets = static_cast<std::uint64_t>(stage.patterns().sets());
  const int shown = scene.calibration.has_fringes ? stage.patterns().sets() : 1;
  for (int set = 0; set < shown; ++set) {
    const auto light = stage.electrons(view, set);
    const auto names = stage.patterns().names(set);
    for (int k = 0; k < (set == 0 ? 2 : 4); ++k) {
      const ExposureId id{scene.seed, stand * sets + static_cast<std::uint64_t>(set), k};
      const auto i = static_cast<std::size_t>(k);
      pictures.push_back({folder + "/" + names[i] + ".png", averager.average(light[i], id)});
    }
  }
  return pictures;
}

Result<void> write_pictures(const std::vector<Picture>& pictures, const SensorConfig& sensor, int width, int height) {
  std::vector<Result<std::string>> encoded(pictures.size(), std::string());
  tbb::parallel_for(std::size_t{0}, pictures.size(),
                    [&](std::size_t i) { encoded[i] = encode(pictures[i], sensor, width, height); });
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    ENAMEL_TRY(encoded[i]);
    ENAMEL_TRY(write_file(pictures[i].path, *encoded[i]));
  }
  return {};
}

/// The mount's angles, a row a pose, and the truth about it.
Result<void> write_axes(const SceneConfig& scene, const std::string& serial, const std::string& folder) {
  const MountRun run = drive(scene.mount, scene.seed);
  const AxesTable table{.key = "pose", .rows = run.stops.size(), .rows_a_stop = 1};
  ENAMEL_TRY(write_file(folder + "/truth/mount_true.json", mount_true_json(run, 1, serial)));
  return write_file(folder + "/axes.csv", axes_csv(run, scene.mount, scene.seed, table));
}

Result<void> write_all(const SceneConfig& scene, const std::string& folder, const std::function<void()>& on_pose) {
  ENAMEL_TRY_ASSIGN(const auto stage, BoardStage::create(scene));
  const FrameAverager averager(stage->sensor(), scene.calibration.frames);
  const calib::LensValues& camera = stage->rig().camera;
  std::string poses = poses_header();
  for (std::size_t n = 0; n < stage->stands().size(); ++n) {
    const std::string pose = fmt::format("{}/poses/{:02}", folder, n);
    ENAMEL_TRY(make_folder(pose));
    ENAMEL_TRY(
        write_pictures(pose_pictures(*stage, n, averager, scene, pose), stage->sensor(), camera.width, camera.height));
    BurstTruth truth;
    truth.burst_index = n;
    truth.T_model_cam = stage->stands()[n];
    poses += poses_row(truth);
    on_pose();
  }
  ENAMEL_TRY_ASSIGN(const std::string nominal,
                    nominal_rig_text(stage->rig(), stage->patterns(), scene.calibration.frames, scene.seed));
  ENAMEL_TRY(make_folder(folder + "/truth"));
  ENAMEL_TRY(write_file(folder + "/truth/rig.json", stage->rig().text));
  ENAMEL_TRY(write_file(folder + "/truth/poses.csv", poses));
  if (scene.path == PathKind::kMount) ENAMEL_TRY(write_axes(scene, stage->rig().serial, folder));
  ENAMEL_TRY(write_file(folder + "/target.json", target_json(scene.board)));
  return write_file(folder + "/rig.json", nominal);
}

}  // namespace

Result<void> write_calibration_folder(const SceneConfig& scene, const std::string& folder,
                                      const std::function<void()>& on_pose) {
  std::error_code ec;
  if (fs::exists(folder, ec) && !fs::is_empty(folder, ec))
    return fail(ErrorCode::kUsage, folder + " is there already; choose another folder");
  const std::string partial = folder + ".partial";
  fs::remove_all(partial, ec);
  ENAMEL_TRY(make_folder(partial));
  Result<void> written = write_all(scene, partial, on_pose);
  if (!written) {
    fs::remove_all(partial, ec);
    return written;
  }
  fs::remove(folder, ec);
  fs::rename(partial, folder, ec);
  if (ec) return fail(ErrorCode::kFileWrite, folder + ": " + ec.message());
  return {};
}

}  // namespace enamel::twin
