#include "host/compare/deviation_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "host/compare/flat_map.hpp"
#include "protocol/base/file.hpp"

namespace enamel::host {
namespace {

constexpr int kWidth = 1200;
constexpr int kMapHeight = 800;
constexpr std::uint8_t kGrey = 225;
constexpr int kFootHeight = 260;
constexpr int kMargin = 40;
constexpr int kBins = 80;

std::uint8_t level(double share) { return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(share, 0.0, 1.0))); }

cv::Scalar bgr(const std::array<std::uint8_t, 3>& rgb) { return {double(rgb[2]), double(rgb[1]), double(rgb[0])}; }

void draw_histogram(const CompareResult& result, double limit_um, cv::Mat& image) {
  std::array<double, kBins> count{};
  for (const float d : result.deviation_um) {
    const double at = (static_cast<double>(d) / limit_um + 1.0) * 0.5 * kBins;
    count[static_cast<std::size_t>(std::clamp(at, 0.0, kBins - 1.0))] += 1.0;
  }
  const double most = *std::max_element(count.begin(), count.end());
  const int bottom = kMapHeight + kFootHeight - 50;
  const int height = kFootHeight - 100;
  const double step = (kWidth - 2.0 * kMargin) / kBins;
  for (int k = 0; k < kBins; ++k) {
    const auto middle = static_cast<float>(((k + 0.5) / kBins * 2.0 - 1.0) * limit_um);
    const int bar = static_cast<int>(height * count[static_cast<std::size_t>(k)] / most);
    const cv::Point low(static_cast<int>(kMargin + k * step), bottom);
    const cv::Point high(static_cast<int>(kMargin + (k + 1) * step) - 1, bottom - bar);
    cv::rectangle(image, low, high, bgr(deviation_colours({middle}, limit_um)[0]), cv::FILLED);
    cv::rectangle(image, low, high, cv::Scalar(120, 120, 120));
  }
  const auto text = [&](const std::string& s, int x, int y) {
    cv::putText(image, s, {x, y}, cv::FONT_HERSHEY_SIMPLEX, 0.6, cv::Scalar(30, 30, 30), 1, cv::LINE_AA);
  };
  std::array<char, 200> line{};
  std::snprintf(line.data(), line.size(),
                "mean |d| %.1f um   median %+.1f   rms %.1f   p95 %.1f   max %.0f   coverage %.1f %%",
                result.mean_abs_um, result.median_um, result.rms_um, result.p95_um, result.max_um, result.coverage_pct);
  text(line.data(), kMargin, kMapHeight + 30);
  std::snprintf(line.data(), line.size(), "-%.0f um", limit_um);
  text(line.data(), kMargin, bottom + 30);
  std::snprintf(line.data(), line.size(), "+%.0f um", limit_um);
  text(line.data(), kWidth - kMargin - 90, bottom + 30);
}

}  // namespace

VertexColours deviation_colours(const std::vector<float>& deviation_um, double limit_um) {
  VertexColours colours;
  for (const float d : deviation_um) {
    const double t = std::clamp(static_cast<double>(d) / limit_um, -1.0, 1.0);
    const std::uint8_t fade = level(1.0 - std::abs(t));
    colours.push_back(t > 0 ? std::array<std::uint8_t, 3>{255, fade, fade}
                            : std::array<std::uint8_t, 3>{fade, fade, 255});
  }
  return colours;
}

std::vector<std::uint8_t> deviation_png(const Mesh& mesh, const CompareResult& result, double limit_um) {
  std::vector<std::uint8_t> png;
  if (mesh.vertices.empty() || result.deviation_um.size() != mesh.vertices.size()) {
    return png;
  }
  cv::Mat image(kMapHeight + kFootHeight, kWidth, CV_8UC3, cv::Scalar(kGrey, kGrey, kGrey));
  const FlatMap map(mesh, {kWidth, kMapHeight, kMargin});
  std::vector<std::uint8_t> drawn = map.drawn(deviation_colours(result.deviation_um, limit_um), kGrey);
  cv::Mat(kMapHeight, kWidth, CV_8UC3, drawn.data()).copyTo(image.rowRange(0, kMapHeight));
  draw_histogram(result, limit_um, image);
  cv::imencode(".png", image, png);
  return png;
}

Result<void> write_deviation(const std::string& folder, const MeshFile& mesh, const CompareResult& result) {
  ENAMEL_TRY(make_folder(folder));
  const auto png = deviation_png(mesh.mesh, result);
  ENAMEL_TRY(write_file(folder + "/deviation.png", {reinterpret_cast<const char*>(png.data()), png.size()}));
  const auto colours = deviation_colours(result.deviation_um, 100.0);
  return write_file(folder + "/deviation.ply", ply_bytes(mesh.mesh, colours, mesh.origin_mm));
}

}  // namespace enamel::host
