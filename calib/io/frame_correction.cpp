#include "calib/io/frame_correction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "calib/io/calib_folder.hpp"

namespace enamel::calib {
namespace {

constexpr double kSmooth_px = 8;
constexpr double kRounding_dn2 = 1.0 / 12;
constexpr double kGrossSigmas = 4;  // dust and dead pixels
constexpr double kSaturatedLevel = 0.98, kMaxSaturated = 0.01;
constexpr double kMinFlatSignal_dn = 20;
constexpr float kMaxGain = 4;

double mean_of(const Map<float>& map) {
  double sum = 0;
  for (const float p : map.pixels()) sum += static_cast<double>(p);
  return sum / static_cast<double>(map.size());
}

/// Share of a pattern of this variance that is not noise.
double signal_share(double variance, double noise) { return variance > noise ? 1 - noise / variance : 0; }

Map<float> smoothed(const Map<float>& map) {
  cv::Mat in(map.height(), map.width(), CV_32F), out;
  std::copy(map.pixels().begin(), map.pixels().end(), in.ptr<float>());
  cv::GaussianBlur(in, out, {}, kSmooth_px, kSmooth_px, cv::BORDER_REFLECT_101);
  Map<float> smooth(map.width(), map.height());
  std::copy_n(out.ptr<float>(), map.size(), &smooth(0, 0));
  return smooth;
}

/// Mean square of values, gross ones left out.
double robust_square(const std::vector<double>& values) {
  double limit = std::numeric_limits<double>::max(), mean = 0;
  for (int round = 0; round < 3; ++round) {
    double sum = 0, n = 0;
    for (const double v : values) {
      if (v * v > limit) continue;
      sum += v * v;
      n += 1;
    }
    mean = n > 0 ? sum / n : 0;
    limit = kGrossSigmas * kGrossSigmas * mean;
  }
  return mean;
}

Result<std::vector<Map<float>>> load_dark(const std::string& folder, int width, int height) {
  std::vector<std::string> paths;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    int n = 0, end = 0;
    const std::string name = entry.path().filename().string();
    if (std::sscanf(name.c_str(), "dark_%d.png%n", &n, &end) == 1 && static_cast<std::size_t>(end) == name.size())
      paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());
  std::vector<Map<float>> frames;
  for (const std::string& path : paths) {
    ENAMEL_TRY_ASSIGN(Map<float> frame, load_grey(path, width, height));
    frames.push_back(std::move(frame));
  }
  return frames;
}

Result<void> check_flat(const Map<float>& flat, double dark_dn, double saturation_dn) {
  const auto full = std::count_if(flat.pixels().begin(), flat.pixels().end(),
                                  [&](float p) { return static_cast<double>(p) >= kSaturatedLevel * saturation_dn; });
  if (static_cast<double>(full) > kMaxSaturated * static_cast<double>(flat.size()))
    return fail(ErrorCode::kCalibrationFolder, "flat.png is saturated; lower the exposure and take it again");
  if (mean_of(flat) - dark_dn < kMinFlatSignal_dn) {
    return fail(ErrorCode::kCalibrationFolder,
                fmt::format("flat.png is {:.0f} DN above dark, at least {:.0f} are needed; light an even white surface",
                            mean_of(flat) - dark_dn, kMinFlatSignal_dn));
  }
  return {};
}

}  // namespace

void FrameCorrection::apply(Map<float>& image) const {
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (dark_frames > 0) image[i] -= dark[i];
    if (gain.size() > 0) image[i] *= gain[i];
  }
}

DarkFrames average_dark(const std::vector<Map<float>>& frames) {
  const double n = static_cast<double>(frames.size());
  DarkFrames out{Map<float>(frames[0].width(), frames[0].height()), {}};
  double over_time = 0;
  for (std::size_t i = 0; i < out.mean.size(); ++i) {
    double sum = 0, squares = 0;
    for (const auto& frame : frames) {
      sum += static_cast<double>(frame[i]);
      squares += static_cast<double>(frame[i]) * static_cast<double>(frame[i]);
    }
    out.mean[i] = static_cast<float>(sum / n);
    if (frames.size() > 1) over_time += (squares - sum * sum / n) / (n - 1) / static_cast<double>(out.mean.size());
  }
  const double level = mean_of(out.mean);
  double over_field = 0;
  for (const float p : out.mean.pixels())
    over_field += std::pow(static_cast<double>(p) - level, 2) / static_cast<double>(out.mean.size());
  const double share = frames.size() > 1 ? signal_share(over_field, over_time / n) : 0;
  for (float& p : out.mean.pixels()) p = static_cast<float>(level + share * (static_cast<double>(p) - level));
  if (frames.size() > 1) out.variance_dn2 = over_time;
  return out;
}

PixelNoise photon_transfer(const Map<float>& flat, double floor_dn2) {
  std::vector<double> differences;  // over the root of the signal
  double signal = 0;
  for (int v = 0; v < flat.height(); ++v) {
    for (int u = 1; u + 1 < flat.width(); ++u) {
      const double a = static_cast<double>(flat(u - 1, v)), b = static_cast<double>(flat(u, v)),
                   c = static_cast<double>(flat(u + 1, v));
      if (!(a + b + c > 0)) continue;
      differences.push_back((a - 2 * b + c) / std::sqrt(6 * (a + b + c) / 3));
      signal += (a + b + c) / 3;
    }
  }
  const double floor = std::max(floor_dn2, kRounding_dn2);
  if (differences.empty()) return {floor, 0};
  const double mean_signal = signal / static_cast<double>(differences.size());
  return {floor, std::max(0.0, robust_square(differences) - floor / mean_signal)};
}

Map<float> flat_gain(const Map<float>& flat, const PixelNoise& noise) {
  const Map<float> smooth = smoothed(flat);
  const double level = mean_of(flat);
  double pattern = 0, expected = 0;
  for (std::size_t i = 0; i < flat.size(); ++i) {
    const double s = std::max(1.0, static_cast<double>(smooth[i]));
    pattern += std::pow(static_cast<double>(flat[i]) / s - 1, 2) / static_cast<double>(flat.size());
    expected += noise.variance(s) / (s * s) / static_cast<double>(flat.size());
  }
  const auto share = static_cast<float>(signal_share(pattern, expected));
  Map<float> gain(flat.width(), flat.height());
  for (std::size_t i = 0; i < flat.size(); ++i) {
    const float even = smooth[i] + share * (flat[i] - smooth[i]);
    gain[i] = even > 0 ? std::clamp(static_cast<float>(level) / even, 1 / kMaxGain, kMaxGain) : kMaxGain;
  }
  return gain;
}

Result<FrameCorrection> read_correction(const std::string& folder, int width, int height, double saturation_dn,
                                        std::optional<PixelNoise> rig_noise) {
  FrameCorrection out;
  ENAMEL_TRY_ASSIGN(const auto frames, load_dark(folder, width, height));
  std::optional<double> floor_dn2;
  if (!frames.empty()) {
    DarkFrames dark = average_dark(frames);
    out.dark = std::move(dark.mean);
    out.dark_frames = static_cast<int>(frames.size());
    floor_dn2 = dark.variance_dn2;
  }
  if (!std::filesystem::exists(folder + "/flat.png")) return out;
  ENAMEL_TRY_ASSIGN(Map<float> flat, load_grey(folder + "/flat.png", width, height));
  ENAMEL_TRY(check_flat(flat, frames.empty() ? 0 : mean_of(out.dark), saturation_dn));
  if (!frames.empty())
    for (std::size_t i = 0; i < flat.size(); ++i) flat[i] -= out.dark[i];
  if (floor_dn2) out.noise = photon_transfer(flat, *floor_dn2);
  // Without the sensor's noise all of the flat's fine pattern is taken for noise: only the shading is divided.
  out.gain = flat_gain(flat, rig_noise.value_or(photon_transfer(flat, floor_dn2.value_or(0))));
  return out;
}

}  // namespace enamel::calib
