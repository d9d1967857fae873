// A drawing as inline SVG: lines, circles, text. Coordinates in the drawing's own units, y down.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>

namespace enamel::calib {

class Svg {
 public:
  Svg(double width, double height) : width_(width), height_(height) {}

  /// `style`: SVG attributes, e.g. stroke="#888" stroke-width="1".
  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::string_view style);
  void circle(const Eigen::Vector2d& middle, double radius, std::string_view style, std::string_view tip = {});
  void rect(const Eigen::Vector2d& corner, const Eigen::Vector2d& size, std::string_view style);
  void text(const Eigen::Vector2d& at, std::string_view words, std::string_view style = {});
  /// A line with a head a third of its length, at most 4 units.
  void arrow(const Eigen::Vector2d& from, const Eigen::Vector2d& along, std::string_view colour, double width);

  [[nodiscard]] std::string str() const;

 private:
  double width_, height_;
  std::string body_;
};

/// Colour of a share 0…1 along a scale from dark violet over green to yellow, even in lightness; clamped.
[[nodiscard]] std::string rising_colour(double share);

/// Blue below, white at, red above zero; share -1…1, clamped. Channels 0…255 in the order red, green, blue.
[[nodiscard]] Eigen::Vector3d diverging_colour(double share);

/// The largest of 1, 2, 5 times a power of ten that is not above `value` (> 0).
[[nodiscard]] double round_number(double value);

}  // namespace enamel::calib
