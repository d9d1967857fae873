// A tooth-like ceramic ground flush with an opaque frame: how much deeper the ceramic looks than the plane it lies in,
// beside what enamel's law says of its contrast. What is left over is this probe's light, this ceramic, and the angles
// of light and view over the field: LightInside.
#pragma once

#include <vector>

#include "calib/model/light_inside.hpp"
#include "pipeline/types/geometry.hpp"
#include "pipeline/types/map.hpp"
#include "protocol/base/result.hpp"

namespace enamel::calib {

/// One burst of the tile at rest.
struct TileView {
  const Map<Vec3f>& points;     ///< camera coordinates, mm, nothing taken off; NaN: none
  const Map<float>& enamel_mm;  ///< by how much enamel's law lifts a pixel; 0 on what is opaque, NaN: unknown
  double pixel_mm = 0.03;       ///< of a pixel on the tile
};

struct TileFit {
  LightInside light;
  double before_um = 0;     ///< rms, means over squares of 16 pixels: ceramic beyond the frame's plane
  double by_enamel_um = 0;  ///< the same with enamel's law as it is
  double after_um = 0;      ///< and with the shares found
  double frame_um = 0;      ///< rms of the frame's squares about its plane: of the tile or of the calibration
};

class CeramicTile {
 public:
  /// False: the burst does not show enough of frame or ceramic, and is not used.
  bool add(const TileView& view);

  /// Errors: kCalibrationPoses: fewer than five bursts used, or a part of the picture in which no burst shows the
  /// ceramic; kCalibrationRefused: a frame that is not plane, or shares that no ceramic has. The details say what to
  /// do.
  [[nodiscard]] Result<TileFit> solve() const;

 private:
  /// Mean over a square of pixels of ceramic.
  struct Square {
    double across = 0, down = 0;  ///< -1 to 1 over the picture
    double off_mm = 0, enamel_mm = 0;
    int burst = 0;
  };
  std::vector<Square> squares_;
  std::vector<double> frame_mm_;  ///< off the plane, squares of the frame
  int bursts_ = 0;
};

}  // namespace enamel::calib
