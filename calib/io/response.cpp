#include "calib/io/response.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

#include "calib/io/calib_folder.hpp"

namespace enamel::calib {
namespace {

constexpr std::size_t kMinLevels = 3;
constexpr double kClippedLevel = 0.98;

double middle_mean(const Map<float>& image) {
  double sum = 0;
  int n = 0;
  for (int v = image.height() / 4; v < image.height() * 3 / 4; ++v)
    for (int u = image.width() / 4; u < image.width() * 3 / 4; ++u, ++n) sum += static_cast<double>(image(u, v));
  return n > 0 ? sum / n : 0;
}

}  // namespace

Result<std::optional<ProjectorResponse>> read_response(const std::string& folder, double saturation_dn) {
  std::map<int, double> mean;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder + "/response", ignored)) {
    int level = 0;
    if (std::sscanf(entry.path().filename().c_str(), "grey_%d.png", &level) != 1) continue;
    ENAMEL_TRY_ASSIGN(const Map<float> image, load_grey(entry.path().string()));
    mean[level] = middle_mean(image);
  }
  if (mean.empty()) return std::nullopt;
  if (mean.size() < kMinLevels) {
    return fail(ErrorCode::kCalibrationFolder, fmt::format("{}/response holds {} grey levels, at least {} are needed",
                                                           folder, mean.size(), kMinLevels));
  }
  const auto [first_level, first] = *mean.begin();
  const auto [last_level, last] = *mean.rbegin();
  if (!(last < kClippedLevel * saturation_dn)) {
    return fail(ErrorCode::kCalibrationFolder,
                folder + "/response: the brightest level is saturated; lower the exposure");
  }
  if (!(last - first > 1))
    return fail(ErrorCode::kCalibrationFolder, folder + "/response: the levels do not differ; was the projector on?");
  ProjectorResponse response;
  for (const auto& [level, value] : mean) {
    const double emission = (value - first) / (last - first);
    const double line = static_cast<double>(level - first_level) / (last_level - first_level);
    response.level.push_back(level);
    response.emission.push_back(emission);
    response.residual = std::max(response.residual, std::abs(emission - line));
  }
  return response;
}

Result<void> check_response(const ProjectorResponse& response) {
  if (response.residual > kMaxResponseResidual) {
    return fail(
        ErrorCode::kCalibrationRefused,
        fmt::format("the projector's response is off a straight line by {:.0f} % of full scale, limit {:.0f} %: load "
                    "its inverse into the projector and take the set again",
                    100 * response.residual, 100 * kMaxResponseResidual));
  }
  if (is_rising(response)) return {};
  return fail(ErrorCode::kCalibrationRefused,
              "the projector's response does not rise from level to level: average more pictures a level, or take "
              "fewer levels");
}

}  // namespace enamel::calib
