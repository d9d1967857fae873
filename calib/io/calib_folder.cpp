#include "calib/io/calib_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include "protocol/base/file.hpp"
#include "protocol/base/litter.hpp"

namespace enamel::calib {
namespace {

namespace fs = std::filesystem;

/// Cycles of the fringes <letter>_<cycles>_<k>.png that lie in a pose's folder.
std::vector<int> cycles_in(const fs::path& pose, char letter) {
  std::set<int> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(pose, ignored)) {
    const std::string name = entry.path().filename().string();
    int cycles = 0, k = 0;
    if (name.size() > 2 && name[0] == letter && std::sscanf(name.c_str() + 1, "_%d_%d.png", &cycles, &k) == 2)
      found.insert(cycles);
  }
  return {found.begin(), found.end()};
}

/// Photon transfer line of one image: the mean of `averaged_frames` exposures, each rounded, rounded again.
PixelNoise image_noise(const NoiseValues& n, int averaged_frames) {
  const double read_dn = n.read_noise_e / n.gain_e_per_dn;
  constexpr double kRounding_dn2 = 1.0 / 12;
  const double frames = averaged_frames;
  return {(read_dn * read_dn + kRounding_dn2) / frames + (averaged_frames > 1 ? kRounding_dn2 : 0.0),
          1 / n.gain_e_per_dn / frames};
}

int averaged_frames(const Rig& rig) {
  const auto json = nlohmann::json::parse(rig.text, nullptr, /*allow_exceptions=*/false);
  if (!json.contains("noise") || !json["noise"].contains("averaged_frames")) return 1;
  const auto& value = json["noise"]["averaged_frames"];
  return value.is_number_integer() ? std::clamp(value.get<int>(), 1, 100'000) : 1;
}

Result<Map<float>> load_sized(const CalibFolder& folder, const std::string& path) {
  return load_grey(path, folder.nominal.camera.width, folder.nominal.camera.height);
}

Result<Map<float>> load_corrected(const CalibFolder& folder, const std::string& path) {
  ENAMEL_TRY_ASSIGN(Map<float> image, load_sized(folder, path));
  folder.correction.apply(image);
  return image;
}

Result<std::vector<FringeLevel>> load_fringes(const CalibFolder& folder, const std::string& pose, char letter,
                                              const std::vector<int>& cycles) {
  std::vector<FringeLevel> levels;
  for (const int c : cycles) {
    FringeLevel level{.cycles = c, .frames = {}};
    for (std::size_t k = 0; k < level.frames.size(); ++k) {
      ENAMEL_TRY_ASSIGN(level.frames[k], load_corrected(folder, fmt::format("{}/poses/{}/{}_{}_{}.png", folder.path,
                                                                            pose, letter, c, k)));
    }
    levels.push_back(std::move(level));
  }
  return levels;
}

}  // namespace

Result<Map<float>> load_grey(const std::string& path) {
  if (!fs::exists(path)) return fail(ErrorCode::kCalibrationFolder, path + " is missing");
  cv::Mat image;
  try {
    image = cv::imread(path, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception& e) {
    return fail(ErrorCode::kImageInvalid, path + ": " + e.what());
  }
  if (image.empty()) return fail(ErrorCode::kImageInvalid, path + ": not a readable image");
  if (image.channels() != 1 || (image.depth() != CV_8U && image.depth() != CV_16U))
    return fail(ErrorCode::kImageInvalid, path + ": not grey of 8 or 16 bit");
  image.convertTo(image, CV_32F);
  Map<float> out(image.cols, image.rows);
  for (int v = 0; v < image.rows; ++v) std::copy_n(image.ptr<float>(v), image.cols, &out(0, v));
  return out;
}

Result<Map<float>> load_grey(const std::string& path, int width, int height) {
  ENAMEL_TRY_ASSIGN(Map<float> image, load_grey(path));
  if (image.width() == width && image.height() == height) return image;
  return fail(ErrorCode::kImageInvalid,
              fmt::format("{}: {} x {} px, rig.json says {} x {}", path, image.width(), image.height(), width, height));
}

Result<CalibFolder> open_calib_folder(const std::string& path, FringeNeed need) {
  CalibFolder folder;
  folder.path = path;
  ENAMEL_TRY_ASSIGN(folder.nominal, load_rig(path + "/rig.json"));
  ENAMEL_TRY_ASSIGN(const std::string target, read_file(path + "/target.json"));
  auto design = parse_target(target);
  if (!design) return fail(design.error().code, path + "/target.json: " + design.error().detail);
  folder.target = *design;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(path + "/poses", ignored))
    if (entry.is_directory() && !is_litter_name(entry.path().filename().string()))
      folder.poses.push_back(entry.path().filename().string());
  std::sort(folder.poses.begin(), folder.poses.end());
  if (folder.poses.empty()) return fail(ErrorCode::kCalibrationFolder, path + "/poses holds no pose");
  // A pose that lacks a frequency shall be told as such: the set is what most poses have, here the largest.
  for (const std::string& pose : folder.poses) {
    const fs::path images = fs::path(path) / "poses" / pose;
    const auto u = cycles_in(images, 'v'), v = cycles_in(images, 'h');
    if (u.size() > folder.cycles_u.size()) folder.cycles_u = u;
    if (v.size() > folder.cycles_v.size()) folder.cycles_v = v;
  }
  if (need == FringeNeed::kBoth && (folder.cycles_u.empty() || folder.cycles_v.empty()))
    return fail(ErrorCode::kCalibrationFolder, path + ": fringes along both axes are needed, v_*.png and h_*.png");
  if (folder.nominal.noise) {
    folder.noise = image_noise(*folder.nominal.noise, averaged_frames(folder.nominal));
    folder.saturation_dn = std::exp2(folder.nominal.noise->bits) - 1;
  }
  ENAMEL_TRY_ASSIGN(folder.correction, read_correction(path, folder.nominal.camera.width, folder.nominal.camera.height,
                                                       folder.saturation_dn, folder.noise));
  if (!folder.noise) folder.noise = folder.correction.noise;
  return folder;
}

Result<PoseFrames> load_pose(const CalibFolder& folder, const std::string& pose) {
  PoseFrames frames;
  frames.name = pose;
  const std::string base = folder.path + "/poses/" + pose + "/";
  ENAMEL_TRY_ASSIGN(frames.white, load_sized(folder, base + "white.png"));
  if (!folder.correction.is_empty()) {
    frames.raw_white = frames.white;
    folder.correction.apply(frames.white);
  }
  ENAMEL_TRY_ASSIGN(frames.black, load_corrected(folder, base + "black.png"));
  ENAMEL_TRY_ASSIGN(frames.along_u, load_fringes(folder, pose, 'v', folder.cycles_u));
  ENAMEL_TRY_ASSIGN(frames.along_v, load_fringes(folder, pose, 'h', folder.cycles_v));
  return frames;
}

}  // namespace enamel::calib
