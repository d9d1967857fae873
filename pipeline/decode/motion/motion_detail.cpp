#include "pipeline/decode/motion/motion_detail.hpp"

#include <algorithm>
#include <utility>

#include "pipeline/decode/motion/motion_detail_rows.hpp"
#include "pipeline/decode/motion/rigid_motion.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {
namespace {

/// layout: places of the fine nodes about a coarse one, in pixels of the images: the middles of its cell's quarters.
constexpr std::array<std::pair<int, int>, 4> kPlaces = {{{-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};

DetailMotion motion_in_floats(const RigidMotion& motion, const RayDepth& rays) {
  DetailMotion m{};
  for (std::size_t k = 0; k < 3; ++k) {
    m.shift_mm[k] = static_cast<float>(motion.shift_mm[k]);
    m.turn_rad[k] = static_cast<float>(motion.turn_rad[k]);
    m.projector_mm[k] = rays.projector_mm[static_cast<Eigen::Index>(k)];
    m.projector_axis[k] = rays.projector_axis[static_cast<Eigen::Index>(k)];
  }
  m.about_mm = static_cast<float>(motion.about_mm);
  return m;
}

/// Rays of the coarse nodes of a row, their first in pixel i, and how 1/z = q goes with the phase there: c1 and c2 are
/// its derivatives, c3 is too small to matter.
void fill_inputs(const RayDepth& rays, const float* q, std::size_t i, std::size_t count, float* inputs) {
  const auto width = static_cast<std::size_t>(rays.width);
  float *x = inputs, *y = x + count, *step_x = y + count, *step_y = step_x + count, *slope = step_y + count;
  for (std::size_t n = 0; n < count; ++n, i += kNode_px) {
    x[n] = rays.rays.x[i], y[n] = rays.rays.y[i];
    step_x[n] = rays.rays.x[i + 1] - x[n];
    step_y[n] = rays.rays.y[i + width] - y[n];
    const float off = select(q[n] == q[n], q[n] - rays.c0[i], 0);  // a hole here may have a surface beside it
    slope[n] = rays.c1[i] + 2 * rays.c2[i] * off / rays.c1[i];
  }
}

}  // namespace

void refine_motion(const RigidMotion& motion, const MotionImages& images, const RayDepth& rays, MotionDetailWork& work,
                   MotionField& field) {
  const auto columns = static_cast<std::size_t>(field.columns), rows = static_cast<std::size_t>(field.rows);
  if (columns < kNodeLanes + 2 || rows < 3) return;
  const std::size_t inner = columns - 2;  // those at the image's border lack half their window
  const DetailMotion m = motion_in_floats(motion, rays);
  work.row.resize((kDetailInputs + 2) * inner);
  float* r = work.row.data();
  const DetailRow row{r, r + inner, r + 2 * inner, r + 3 * inner, r + 4 * inner, r + 5 * inner, r + 6 * inner};
  for (auto* v : {&work.rate_rad, &work.light}) v->resize(4 * columns * rows);
  for (std::size_t v = 0; v < 2 * rows; ++v) {
    for (std::size_t u = 0; u < 2 * columns; ++u) {
      const std::size_t coarse = v / 2 * columns + u / 2, fine = v * 2 * columns + u;
      work.rate_rad[fine] = field.rate_rad[coarse], work.light[fine] = field.light[coarse];
    }
  }
  for (std::size_t node_row = 1; node_row + 1 < rows; ++node_row) {
    const int v = static_cast<int>(node_row) * kNode_px + kNode_px / 2;
    fill_inputs(rays, images.inverse_depth.around(static_cast<int>(node_row), 0, 0) + 1,
                static_cast<std::size_t>(v * rays.width + kNode_px + kNode_px / 2), inner, r);
    for (const auto& [x, y] : kPlaces) {
      std::copy_n(&field.rate_rad[node_row * columns + 1], inner, row.rate);
      std::copy_n(&field.light[node_row * columns + 1], inner, row.light);
      detail_row(images, static_cast<int>(node_row), x, y, static_cast<int>(inner), m, row);
      const std::size_t to = (2 * node_row + (y > 0 ? 1 : 0)) * 2 * columns + 2 + (x > 0 ? 1 : 0);
      for (std::size_t n = 0; n < inner; ++n)
        work.rate_rad[to + 2 * n] = row.rate[n], work.light[to + 2 * n] = row.light[n];
    }
  }
  std::swap(field.rate_rad, work.rate_rad);
  std::swap(field.light, work.light);
  field.detail = 2;
}

}  // namespace enamel::pipeline
