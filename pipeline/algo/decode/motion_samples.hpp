// The pixels that the motion is judged by: every second one of every second row about every second node. Private to
// algo/decode.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/algo/phase/polarity.hpp"

namespace enamel::algo {

inline constexpr std::size_t kNodePixels = 16;
inline constexpr std::size_t kNodeLanes = 8;  ///< nodes are padded to a multiple of it by ones without pixels

/// Columns of the closure residual y of each pixel (closure.hpp), polarity undone, for eps, dA/B and rho; pixel p of
/// node n at [p * nodes + n]. All 0 where a pixel says nothing.
struct MotionSamples {
  std::size_t nodes = 0;
  std::vector<std::int32_t> node;          ///< index in the grid of nodes
  std::vector<float> rate, rate_per_rate;  ///< column of eps at eps = 0, and its slope over eps: second order
  std::vector<float> light, harmonic, residual, used;
};

/// max_residual: of B.
void take_samples(const PhaseMaps& maps, const PolarityMaps& polarity, float black_dn, float max_residual,
                  MotionSamples& out);

/// Columns of eps and of dA/B for the six unknowns (V, W) at each sampled node, [k * nodes + n]; 0 where a node's slope
/// is unknown or too steep, and counts 0 there, else 1.
struct MotionColumns {
  std::vector<float> rate, light, counts;
};

struct MotionEquations {
  std::array<std::array<double, 8>, 7> left{};  ///< upper triangle and more; column 7 unused
  std::array<double, 8> right{};
  double squares = 0, pixels = 0;
};

}  // namespace enamel::algo
