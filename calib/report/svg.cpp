#include "calib/report/svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "protocol/base/xml.hpp"

namespace enamel::calib {

using Eigen::Vector2d;
using Eigen::Vector3d;

void Svg::line(const Vector2d& from, const Vector2d& to, std::string_view style) {
  body_ += fmt::format("<line x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\" {}/>\n", from.x(), from.y(),
                       to.x(), to.y(), style);
}

void Svg::circle(const Vector2d& middle, double radius, std::string_view style, std::string_view tip) {
  body_ += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\" {}>", middle.x(), middle.y(), radius, style);
  if (!tip.empty()) body_ += "<title>" + xml_escaped(tip) + "</title>";
  body_ += "</circle>\n";
}

void Svg::rect(const Vector2d& corner, const Vector2d& size, std::string_view style) {
  body_ += fmt::format("<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" {}/>\n", corner.x(),
                       corner.y(), size.x(), size.y(), style);
}

void Svg::text(const Vector2d& at, std::string_view words, std::string_view style) {
  body_ += fmt::format("<text x=\"{:.2f}\" y=\"{:.2f}\" {}>{}</text>\n", at.x(), at.y(), style, xml_escaped(words));
}

void Svg::arrow(const Vector2d& from, const Vector2d& along, std::string_view colour, double width) {
  const double length = along.norm();
  if (!(length > 0)) return;
  const Vector2d to = from + along, back = -along / length * std::min(4.0, length / 3), side(-back.y(), back.x());
  const std::string style = fmt::format("stroke=\"{}\" stroke-width=\"{}\"", colour, width);
  line(from, to, style);
  line(to, to + back + 0.5 * side, style);
  line(to, to + back - 0.5 * side, style);
}

std::string Svg::str() const {
  return fmt::format("<svg viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\">\n{2}</svg>\n", width_,
                     height_, body_);
}

std::string rising_colour(double share) {
  // Stops of matplotlib's viridis, which is even in lightness and readable without colour vision.
  static const std::array<Vector3d, 5> kStops{Vector3d(68, 1, 84), Vector3d(59, 82, 139), Vector3d(33, 145, 140),
                                              Vector3d(94, 201, 98), Vector3d(230, 200, 20)};
  const double at = std::clamp(share, 0.0, 1.0) * (kStops.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(at), kStops.size() - 2);
  const Vector3d c = kStops[below] + (at - static_cast<double>(below)) * (kStops[below + 1] - kStops[below]);
  return fmt::format("rgb({:.0f},{:.0f},{:.0f})", c.x(), c.y(), c.z());
}

Vector3d diverging_colour(double share) {
  const Vector3d white(247, 247, 247), end = share < 0 ? Vector3d(33, 102, 172) : Vector3d(178, 24, 43);
  return white + std::clamp(std::abs(share), 0.0, 1.0) * (end - white);
}

double round_number(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  const double lead = value / power;
  return power * (lead >= 5 ? 5 : lead >= 2 ? 2 : 1);
}

}  // namespace enamel::calib
