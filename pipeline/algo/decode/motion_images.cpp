#include "pipeline/algo/decode/motion_images.hpp"

#include "pipeline/algo/decode/surface.hpp"
#include "pipeline/algo/phase/closure_rows.hpp"

namespace enamel::algo {

void MotionImage::resize(int width, int height) {
  width_ = (width + 1) / 2;
  height_ = (height + 1) / 2;
  pitch_ = (width_ + 3) / 4;
  data_.resize(4 * static_cast<std::size_t>(pitch_) * static_cast<std::size_t>(height_));
}

void MotionImage::set_row(int y, const float* row) {
  float* out = data_.data() + static_cast<std::ptrdiff_t>(y) * 4 * pitch_;
  for (int place = 0; place < 4; ++place, out += pitch_) {
    const int count = (width_ - place + 3) / 4;
    for (int k = 0; k < count; ++k) out[k] = row[4 * k + place];
  }
}

void make_motion_images(const PhaseMaps& maps, const PolarityMaps& polarity, const RayDepth& rays,
                        const BurstErrors& errors, float black_dn, bool same_burst, MotionImages& out) {
  const int width = maps.phase_rad.width(), height = maps.phase_rad.height();
  const auto columns = static_cast<std::size_t>(width + 1) / 2;
  out.inverse_depth.resize(width, height);
  out.light.resize(width, height);
  if (!same_burst) out.pixels.take(maps, polarity);
  out.phase.resize(columns);
  out.row.resize(columns);
  out.light_row.resize(columns);
  ErrorRows rows(errors, black_dn, width, {0, kSparseStep});
  for (int v = 0; v < height; v += 2) {
    mid_burst_row(out.pixels.row(rows, v), columns, out.phase.data(), out.light_row.data());
    out.light.set_row(v / 2, out.light_row.data());
    sparse_inverse_depth_row(maps, polarity.turn, rays, 0, v, out.phase.data(), out.row.data());
    out.inverse_depth.set_row(v / 2, out.row.data());
  }
}

}  // namespace enamel::algo
