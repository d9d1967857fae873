// The loop of motion_detail.hpp over the nodes of a row. Private to pipeline/decode.
#pragma once

#include <array>
#include <cstddef>

#include "pipeline/decode/motion/motion_images.hpp"

namespace enamel::pipeline {

inline constexpr std::size_t kDetailInputs = 5;  ///< layout: arrays of a DetailRow that are filled before

/// One value a node, of nodes at one place between those of the coarse grid.
struct DetailRow {
  const float *x, *y;            ///< of the coarse node's ray (x, y, 1)
  const float *step_x, *step_y;  ///< of x and y per pixel of the camera
  const float* slope;            ///< dq/dPhi
  float *rate, *light;           ///< eps and dA/A; as they are where the slope of the surface is unknown
};

struct DetailMotion {
  std::array<float, 3> shift_mm, turn_rad, projector_mm, projector_axis;
  float about_mm;  ///< turns are about (0, 0, about_mm)
};

/// Nodes 1 … count of node_row, their middles (place_x, place_y) image pixels off those of the coarse grid, |place|
/// <= 1. Arrays begin at node 1 and hold at least kNodeLanes values.
void detail_row(const MotionImages& images, int node_row, int place_x, int place_y, int count,
                const DetailMotion& motion, const DetailRow& row);

}  // namespace enamel::pipeline
