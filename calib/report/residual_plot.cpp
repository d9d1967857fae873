#include "calib/report/residual_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "calib/report/svg.hpp"
#include "protocol/base/xml.hpp"

namespace enamel::calib {
namespace {

using Eigen::Vector2d;

constexpr double kField = 460, kFieldMargin = 6, kFieldLegend = 26;  // width, border and legend of a field, SVG units
constexpr int kCols = 8, kRows = 6;
constexpr double kMeanLength = 4;  // times that of single residuals
constexpr double kBeyondDoubt = 3;
constexpr int kBlock_px = 5;  // of a plane's samples

struct Cell {
  Vector2d sum{0, 0}, squares{0, 0};
  double count = 0;

  void add(const Vector2d& r) {
    sum += r;
    squares += r.cwiseAbs2();
    count += 1;
  }
  [[nodiscard]] Vector2d mean() const { return sum / count; }
  [[nodiscard]] bool is_systematic() const {
    const Vector2d variance = (squares / count - mean().cwiseAbs2()) / (count - 1);
    return (mean().cwiseAbs().array() > kBeyondDoubt * variance.cwiseMax(0).cwiseSqrt().array()).any();
  }
};

std::array<Cell, kCols * kRows> cells_of(const std::vector<FieldArrow>& arrows, int width_px, int height_px) {
  std::array<Cell, kCols * kRows> cells;
  for (const FieldArrow& a : arrows) {
    const int col = std::clamp(static_cast<int>(a.at_px.x() * kCols / width_px), 0, kCols - 1);
    const int row = std::clamp(static_cast<int>(a.at_px.y() * kRows / height_px), 0, kRows - 1);
    cells[static_cast<std::size_t>(row * kCols + col)].add(a.residual_px);
  }
  return cells;
}

std::string base64(const std::vector<unsigned char>& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (i + k < bytes.size() ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? kDigits[word >> (18 - 6 * k) & 63U] : '=';
  }
  return out;
}

/// An arrow from a place in the field, no longer than to the field's border.
Vector2d cut_at_border(const Vector2d& from, const Vector2d& along, const Vector2d& field) {
  double share = 1;
  for (Eigen::Index k = 0; k < 2; ++k) {
    const double room = along[k] > 0 ? field[k] - from[k] : from[k];
    if (std::abs(along[k]) > room) share = std::min(share, room / std::abs(along[k]));
  }
  return share * along;
}

}  // namespace

std::string residual_field(const std::vector<FieldArrow>& arrows, int width_px, int height_px) {
  const double zoom = (kField - 2 * kFieldMargin) / width_px, tall = zoom * height_px;
  Svg svg(kField, tall + 2 * kFieldMargin + kFieldLegend);
  const Vector2d corner(kFieldMargin, kFieldMargin);
  svg.rect(corner, {zoom * width_px, tall}, "class=\"field\"");
  double squares = 0;
  for (const FieldArrow& a : arrows) squares += a.residual_px.squaredNorm();
  if (arrows.empty() || !(squares > 0)) return svg.str();
  const double legend_px = round_number(2 * std::sqrt(squares / static_cast<double>(arrows.size())));
  const double length = 14 / legend_px;  // SVG units a pixel of residual
  for (const FieldArrow& a : arrows) svg.arrow(corner + zoom * a.at_px, length * a.residual_px, "#9fb0bf", 0.7);
  const auto cells = cells_of(arrows, width_px, height_px);
  for (int i = 0; i < kCols * kRows; ++i) {
    const Cell& cell = cells[static_cast<std::size_t>(i)];
    if (cell.count < 4) continue;
    const int col = i % kCols, row = i / kCols;
    const Vector2d middle((col + 0.5) * width_px / kCols, (row + 0.5) * height_px / kRows);
    const Vector2d along = cut_at_border(zoom * middle, kMeanLength * length * cell.mean(), {zoom * width_px, tall});
    svg.arrow(corner + zoom * middle, along, cell.is_systematic() ? "#c0392b" : "#1f3a5f", 1.8);
  }
  const double y = tall + 2 * kFieldMargin + 14;
  svg.arrow({kFieldMargin, y - 4}, {14, 0}, "#9fb0bf", 1.2);
  svg.text({kFieldMargin + 20, y}, fmt::format("one dot: {:g} px", legend_px));
  svg.arrow({150, y - 4}, {14, 0}, "#1f3a5f", 1.8);
  svg.text({170, y}, fmt::format("cell mean: {:g} px", legend_px / kMeanLength));
  svg.arrow({330, y - 4}, {14, 0}, "#c0392b", 1.8);
  svg.text({350, y}, "beyond 3 sigma");
  return svg.str();
}

Result<std::string> plane_map(const PlaneCheck& plane, int width_px, int height_px, double limit_um) {
  const int cols = width_px / kBlock_px, rows = height_px / kBlock_px;
  Map<double> sum(cols, rows), count(cols, rows);
  for (const PlaneHeight& h : plane.heights) {
    const int u = static_cast<int>(h.camera_px.x()) / kBlock_px, v = static_cast<int>(h.camera_px.y()) / kBlock_px;
    for (int y = std::max(0, v - 1); y <= std::min(rows - 1, v + 1); ++y) {
      for (int x = std::max(0, u - 1); x <= std::min(cols - 1, u + 1); ++x) {
        sum(x, y) += h.height_um;
        count(x, y) += 1;
      }
    }
  }
  cv::Mat picture(rows, cols, CV_8UC3, cv::Scalar(225, 222, 220));
  for (const PlaneHeight& h : plane.heights) {
    const int u = static_cast<int>(h.camera_px.x()) / kBlock_px, v = static_cast<int>(h.camera_px.y()) / kBlock_px;
    const Eigen::Vector3d c = diverging_colour(sum(u, v) / count(u, v) / limit_um);
    picture.at<cv::Vec3b>(v, u) =
        cv::Vec3b(cv::saturate_cast<unsigned char>(c.z()), cv::saturate_cast<unsigned char>(c.y()),
                  cv::saturate_cast<unsigned char>(c.x()));
  }
  std::vector<unsigned char> png;
  if (!cv::imencode(".png", picture, png)) return fail(ErrorCode::kInternal, "a plane's picture cannot be encoded");
  return fmt::format(
      "<img class=\"map\" alt=\"plane of pose {}\" width=\"{}\" height=\"{}\" src=\"data:image/png;base64,{}\">",
      xml_escaped(plane.pose), 2 * cols, 2 * rows, base64(png));
}

}  // namespace enamel::calib
