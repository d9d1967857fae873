// How much of each pixel a blurred ellipse covers, and how that changes with the ellipse.
#pragma once

#include <Eigen/Core>

#include "calib/target/ellipse.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::calib {

/// Two cameras: one whose lens blurs the light before the pixels integrate it, and one that is blurred after them (or
/// rendered so). Below a blur of 0.8 px they differ by some per cent of the step, enough to move a centre by 0.004 px
/// with its place in the pixel.
enum class EdgeModel { kLensThenPixel, kPixelThenTaps };

/// Pixels u0 … u1, v0 … v1, both ends included.
struct PixelWindow {
  int u0 = 0, v0 = 0, u1 = -1, v1 = -1;
};

struct CoverJet {
  double cover = 0;  ///< 0…1
  /// By centre u, v, shape (0,0), (0,1) with (1,0), (1,1), blur.
  Eigen::Matrix<double, 6, 1> slope = Eigen::Matrix<double, 6, 1>::Zero();
};

/// Signed distance of p to the contour, px, positive inside: first order in the distance (Taubin 1991).
[[nodiscard]] double inside_px(const Ellipse& e, const Eigen::Vector2d& p);

/// Coverage over a window. Where a contour bends sharply, a pixel is put together of smaller squares: the edge inside
/// each is then as good as an arc. `start` tells how sharply; what render() is given may differ from it by some pixels.
/// Not thread-safe: one object a thread.
class DiscCover {
 public:
  DiscCover(EdgeModel model, const PixelWindow& window, const Ellipse& start);

  /// Fills the window. `blur_px` is the Gaussian's sigma, for kPixelThenTaps of its samples at whole pixels; the
  /// pixel's own square is not included.
  void render(const Ellipse& e, double blur_px);

  /// p: a whole pixel of the window.
  [[nodiscard]] const CoverJet& at(const Eigen::Vector2d& p) const {
    return seen_(static_cast<int>(p.x()) - u0_, static_cast<int>(p.y()) - v0_);
  }

 private:
  [[nodiscard]] CoverJet pixel(const Ellipse& e, const Eigen::Vector2d& p, double blur_px) const;
  void blur_with_taps(const Ellipse& e, double blur_px);

  EdgeModel model_;
  int pieces_;                  // squares along a pixel's side
  int u0_, v0_;                 // of the maps' corner
  Map<CoverJet> sharp_, seen_;  // before and after the taps; the window and a border as wide as they reach
};

}  // namespace enamel::calib
