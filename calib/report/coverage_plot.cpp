#include "calib/report/coverage_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "calib/report/svg.hpp"

namespace enamel::calib {
namespace {

using Eigen::Vector2d;

constexpr double kPlot = 460, kMargin = 6;

double share_of(double depth_mm, DepthRange range) {
  return (depth_mm - range.near_mm) / (range.far_mm - range.near_mm);
}

/// The colours' meaning: a bar with the range's ends.
void depth_legend(Svg& svg, const Vector2d& at, DepthRange range) {
  constexpr int kSteps = 24;
  constexpr double kWide = 120;
  for (int i = 0; i < kSteps; ++i) {
    svg.rect(at + Vector2d(50 + kWide * i / kSteps, -9), {kWide / kSteps + 0.5, 10},
             fmt::format("fill=\"{}\"", rising_colour((i + 0.5) / kSteps)));
  }
  svg.text(at, fmt::format("{:g} mm", range.near_mm));
  svg.text(at + Vector2d(56 + kWide, 0), fmt::format("{:g} mm", range.far_mm));
}

Vec3d place_of(const Solution& s, const TargetDesign& target, std::size_t pose, const DotView& dot) {
  return s.state.T_cam_target[pose] * target.place(dot.dot);
}

std::string fill(double depth_mm, DepthRange range) {
  return fmt::format("fill=\"{}\"", rising_colour(share_of(depth_mm, range)));
}

/// Pixel of a value on an axis of a chart.
struct Axis {
  double low = 0, high = 1, from = 0, to = 1;
  [[nodiscard]] double operator()(double value) const { return from + (to - from) * (value - low) / (high - low); }
};

struct Curve {
  const char* name;
  double PlaneShape::*part;
};
constexpr std::array<Curve, 3> kCurves{
    {{"sag along x", &PlaneShape::sag_x_um}, {"sag along y", &PlaneShape::sag_y_um}, {"twist", &PlaneShape::twist_um}}};

void draw_curve(Svg& svg, const Curve& curve, const Judgement& j, const Axis& x, const Axis& y, double limit_um) {
  const double left = x.from, right = x.to;
  svg.rect({left, y(limit_um)}, {right - left, y(-limit_um) - y(limit_um)}, "fill=\"#e8f3ea\"");
  svg.line({left, y(0)}, {right, y(0)}, "stroke=\"#888\" stroke-width=\"0.8\"");
  svg.text({left, y.to - 8}, curve.name, "font-weight=\"600\"");
  for (const PlaneCheck& p : j.planes) {
    const double at = std::clamp(p.shape.*curve.part, y.low, y.high);
    svg.circle({x(p.depth_mm), y(at)}, 3, "fill=\"none\" stroke=\"#7b8a99\"",
               fmt::format("pose {}: {:.2f} um", p.pose, p.shape.*curve.part));
  }
  for (const DepthShape& s : j.shapes) {
    const double value = s.shape.*curve.part, both = 2 * (s.sigma.*curve.part);
    svg.line({x(s.depth_mm), y(std::clamp(value - both, y.low, y.high))},
             {x(s.depth_mm), y(std::clamp(value + both, y.low, y.high))}, "stroke=\"#1f3a5f\" stroke-width=\"2\"");
    svg.circle({x(s.depth_mm), y(std::clamp(value, y.low, y.high))}, 4, "fill=\"#1f3a5f\"",
               fmt::format("{:.3f} +- {:.3f} um at {:g} mm", value, 0.5 * both, s.depth_mm));
    svg.text({x(s.depth_mm) - 8, y.from + 14}, fmt::format("{:g}", s.depth_mm));
  }
}

}  // namespace

double tilt_deg(const Pose& T_cam_target) {
  return std::acos(std::clamp(-T_cam_target.linear()(2, 2), -1.0, 1.0)) * 180 / std::numbers::pi;
}

std::string field_coverage(const Solution& s, const TargetDesign& target, DepthRange range) {
  const LensValues& camera = s.state.camera;
  const double zoom = (kPlot - 2 * kMargin) / camera.width, tall = zoom * camera.height;
  Svg svg(kPlot, tall + 2 * kMargin + 26);
  svg.rect({kMargin, kMargin}, {zoom * camera.width, tall}, "class=\"field\"");
  for (std::size_t j = 0; j < s.poses.size(); ++j) {
    for (const DotView& dot : s.poses[j].dots) {
      svg.circle(Vector2d(kMargin, kMargin) + zoom * dot.camera_px, 2.6,
                 fill(place_of(s, target, j, dot).z(), range) + " fill-opacity=\"0.75\"");
    }
  }
  depth_legend(svg, {kMargin, tall + 2 * kMargin + 14}, range);
  return svg.str();
}

std::string tilt_coverage(const Solution& s, const TargetDesign& target, DepthRange range) {
  constexpr double kSide = 320, kScale = 3.2;  // SVG units, units a degree
  const Vector2d middle(kSide / 2, kSide / 2);
  Svg svg(kSide, kSide + 26);
  svg.circle(middle, 25 * kScale, fmt::format("fill=\"none\" stroke=\"#e8f3ea\" stroke-width=\"{}\"", 20 * kScale));
  for (const int ring : {15, 30, 45}) {
    svg.circle(middle, ring * kScale, "fill=\"none\" stroke=\"#bbb\" stroke-width=\"0.8\"");
    svg.text(middle + Vector2d(3, -ring * kScale + 11), fmt::format("{}°", ring), "class=\"tick\"");
  }
  for (std::size_t j = 0; j < s.poses.size(); ++j) {
    const Vec3d normal = s.state.T_cam_target[j].linear().col(2);
    const double across = std::hypot(normal.x(), normal.y());
    const Vector2d way = across > 0 ? Vector2d(normal.head<2>() / across) : Vector2d(0, 0);
    const Vector2d at = middle + kScale * std::min(48.0, tilt_deg(s.state.T_cam_target[j])) * way;
    const double depth = (s.state.T_cam_target[j] * target.place(target.size() / 2)).z();
    svg.circle(at, 7, fill(depth, range) + " stroke=\"#fff\"",
               fmt::format("pose {}, {:.1f} mm", s.poses[j].name, depth));
    svg.text(at + Vector2d(9, 4), s.poses[j].name, "class=\"tick\"");
  }
  depth_legend(svg, {50, kSide + 14}, range);
  return svg.str();
}

std::string depth_coverage(const Solution& s, const TargetDesign& target, DepthRange range) {
  constexpr double kRow = 18;
  const double tall = kRow * static_cast<double>(s.poses.size());
  const double slack = 0.15 * (range.far_mm - range.near_mm);
  const Axis x{range.near_mm - slack, range.far_mm + slack, 60, kPlot - kMargin};
  Svg svg(kPlot, tall + 30);
  svg.rect({x(range.near_mm), 4}, {x(range.far_mm) - x(range.near_mm), tall + 4}, "fill=\"#e8f3ea\"");
  for (std::size_t j = 0; j < s.poses.size(); ++j) {
    double low = range.far_mm * 10, high = 0;
    for (const DotView& dot : s.poses[j].dots) {
      const double z = place_of(s, target, j, dot).z();
      low = std::min(low, z);
      high = std::max(high, z);
    }
    const double y = 8 + kRow * static_cast<double>(j);
    svg.text({4, y + 9}, s.poses[j].name.substr(0, 8), "class=\"tick\"");
    svg.rect({x(std::max(low, x.low)), y}, {std::max(1.0, x(std::min(high, x.high)) - x(std::max(low, x.low))), 10},
             fill(0.5 * (low + high), range) + " rx=\"3\"");
  }
  for (const double edge : {range.near_mm, 0.5 * (range.near_mm + range.far_mm), range.far_mm})
    svg.text({x(edge) - 16, tall + 24}, fmt::format("{:g} mm", edge), "class=\"tick\"");
  return svg.str();
}

std::string shape_chart(const Judgement& j, DepthRange range, double limit_um) {
  constexpr double kWide = 300, kTall = 210;
  double most = 1.5 * limit_um;
  for (const DepthShape& s : j.shapes)
    for (const Curve& c : kCurves) most = std::max(most, std::abs(s.shape.*c.part) + 2 * (s.sigma.*c.part));
  for (const PlaneCheck& p : j.planes)
    for (const Curve& c : kCurves) most = std::max(most, std::min(4 * limit_um, std::abs(p.shape.*c.part)));
  const double slack = 0.08 * (range.far_mm - range.near_mm);
  Svg svg(kWide * static_cast<double>(kCurves.size()), kTall);
  for (std::size_t k = 0; k < kCurves.size(); ++k) {
    const double left = kWide * static_cast<double>(k);
    const Axis x{range.near_mm - slack, range.far_mm + slack, left + 34, left + kWide - 14};
    const Axis y{-1.05 * most, 1.05 * most, kTall - 24, 28};
    draw_curve(svg, kCurves[k], j, x, y, limit_um);
    for (const double value : {-limit_um, 0.0, limit_um})
      svg.text({left + 4, y(value) + 4}, fmt::format("{:g}", value), "class=\"tick\"");
    svg.text({x.to - 16, y.from + 14}, "mm", "class=\"tick\"");
  }
  return svg.str();
}

}  // namespace enamel::calib
