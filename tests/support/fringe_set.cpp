#include "tests/support/fringe_set.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace enamel::test {
namespace {

Result<cv::Mat> matrix(const cv::FileStorage& file, const char* name, int count) {
  cv::Mat m;
  file[name] >> m;
  if (m.empty() || m.type() != CV_64F || static_cast<int>(m.total()) != count)
    return fail(ErrorCode::kRigInvalid, std::string("matrix '") + name + "' is missing or has another size");
  return m;
}

Result<calib::LensValues> lens(const cv::FileStorage& file, const char* intrinsics, const char* distortion) {
  calib::LensValues out;
  ENAMEL_TRY_ASSIGN(const cv::Mat m, matrix(file, intrinsics, 9));
  ENAMEL_TRY_ASSIGN(const cv::Mat d, matrix(file, distortion, 5));
  out.fx = m.at<double>(0, 0), out.fy = m.at<double>(1, 1);
  out.cx = m.at<double>(0, 2), out.cy = m.at<double>(1, 2);
  for (int k = 0; k < 5; ++k) out.dist[static_cast<std::size_t>(k)] = d.at<double>(k);
  return out;
}

}  // namespace

std::vector<std::string> numbered(const std::string& prefix, int first, int count, int step) {
  std::vector<std::string> names;
  for (int k = 0; k < count; ++k) {
    std::array<char, 16> digits{};
    std::snprintf(digits.data(), digits.size(), "%02d", first + k * step);
    names.push_back(prefix + digits.data());
  }
  return names;
}

Result<FringeImages> load_fringe_images(const std::string& folder, const std::vector<std::string>& names) {
  FringeImages set;
  for (const std::string& name : names) {
    const std::string path = fmt::format("{}/{}.png", folder, name);
    if (!std::filesystem::exists(path)) return fail(ErrorCode::kFileNotFound, path);
    const cv::Mat image = cv::imread(path, cv::IMREAD_UNCHANGED);
    if (image.empty() || image.type() != CV_8UC1) return fail(ErrorCode::kImageInvalid, path + ": not 8-bit grey");
    if (!set.images.empty() && (image.cols != set.width || image.rows != set.height))
      return fail(ErrorCode::kImageInvalid, path + ": of another size than " + names.front());
    set.width = image.cols;
    set.height = image.rows;
    auto& out = set.images.emplace_back();
    for (int v = 0; v < image.rows; ++v)
      out.insert(out.end(), image.ptr<std::uint8_t>(v), image.ptr<std::uint8_t>(v) + image.cols);
  }
  if (set.images.empty()) return fail(ErrorCode::kEmptyInput, folder);
  return set;
}

Result<FrameSet> burst_of(const FringeImages& set, std::size_t first, std::size_t step) {
  if (first + 3 * step >= set.images.size()) {
    return fail(ErrorCode::kBurstNotFound,
                "image " + std::to_string(first + 3 * step) + " of " + std::to_string(set.images.size()));
  }
  FrameSet burst{set.width, set.height, {}};
  for (std::size_t k = 0; k < 4; ++k) burst.frames[k] = set.images[first + k * step];
  return burst;
}

StepSolution solve_steps(const FringeImages& set, std::size_t n) {
  StepSolution out{Map<float>(set.width, set.height), Map<float>(set.width, set.height),
                   Map<float>(set.width, set.height)};
  for (std::size_t i = 0; i < out.phase_rad.size(); ++i) {
    std::complex<double> z = 0;
    double sum = 0;
    for (std::size_t k = 0; k < n; ++k) {
      const double value = set.images[k][i];
      z += value * std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n));
      sum += value;
    }
    out.phase_rad[i] = static_cast<float>(std::arg(z));
    out.amplitude_dn[i] = static_cast<float>(2 * std::abs(z) / static_cast<double>(n));
    out.mean_dn[i] = static_cast<float>(sum / static_cast<double>(n));
  }
  return out;
}

Map<std::int32_t> decode_gray(const FringeImages& set, std::size_t first, std::size_t bits,
                              const Map<float>& threshold_dn) {
  Map<std::int32_t> out(set.width, set.height);
  for (std::size_t i = 0; i < out.size(); ++i) {
    std::int32_t number = 0, bit = 0;
    for (std::size_t k = 0; k < bits; ++k) {
      bit ^= static_cast<float>(set.images[first + k][i]) > threshold_dn[i] ? 1 : 0;
      number = 2 * number + bit;
    }
    out[i] = number;
  }
  return out;
}

Result<calib::Rig> load_camera_projector(const std::string& path, int width, int height,
                                         const ProjectorFacts& projector) {
  const cv::FileStorage file(path, cv::FileStorage::READ);
  if (!file.isOpened()) return fail(ErrorCode::kFileNotFound, path);
  calib::Rig rig;
  ENAMEL_TRY_ASSIGN(rig.camera, lens(file, "M1", "D1"));
  ENAMEL_TRY_ASSIGN(rig.projector, lens(file, "M4", "D4"));
  rig.camera.width = width, rig.camera.height = height;
  rig.projector.width = projector.width, rig.projector.height = projector.height;
  ENAMEL_TRY_ASSIGN(const cv::Mat r, matrix(file, "Rlp", 9));
  ENAMEL_TRY_ASSIGN(const cv::Mat t, matrix(file, "Tlp", 3));
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t col = 0; col < 3; ++col)
      rig.T_proj_cam[row][col] = r.at<double>(static_cast<int>(row), static_cast<int>(col));
    rig.T_proj_cam[row][3] = t.at<double>(static_cast<int>(row));
  }
  rig.T_proj_cam[3] = {0, 0, 0, 1};
  rig.patterns.mode = calib::PatternMode::kPlain4;
  rig.patterns.period_px = projector.period_px;
  return rig;
}

}  // namespace enamel::test
