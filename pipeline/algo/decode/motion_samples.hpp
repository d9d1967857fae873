// The pixels that the motion is judged by: every second one of every second row about every second node. Private to
// algo/decode.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/algo/decode/motion_pixels.hpp"
#include "pipeline/algo/phase/closure_rows.hpp"
#include "pipeline/algo/phase/polarity.hpp"

namespace enamel::algo {

inline constexpr std::size_t kNodePixels = 16;
inline constexpr std::size_t kNodeLanes = 8;  ///< nodes are padded to a multiple of it by ones without pixels

/// Columns of the residual y of each pixel for eps, dA/A and a number that all pixels share (motion_view.hpp); pixel p
/// of node n at place(p, n). All 0 where a pixel says nothing.
struct MotionSamples {
  std::size_t nodes = 0;
  std::vector<std::int32_t> node;          ///< index in the grid of nodes
  std::vector<float> rate, rate_per_rate;  ///< column of eps at eps = 0, and its slope over eps: second order
  std::vector<float> light, shared, residual, used;
  SampledPixels pixels;    ///< of mode T
  std::vector<float> row;  ///< scratch

  /// kNodeLanes nodes side by side, all their pixels one after the other, then the next nodes.
  [[nodiscard]] static std::size_t place(std::size_t pixel, std::size_t node) noexcept {
    return (node / kNodeLanes * kNodePixels + pixel) * kNodeLanes + node % kNodeLanes;
  }
};

inline constexpr int kPixelStep = 2;  ///< pixel p of a node: of each row kNode_px / kPixelStep

/// Column of a node at which its pixels in image row v begin: rows take turns.
[[nodiscard]] constexpr int first_column(int v) noexcept { return v / kPixelStep % kPixelStep; }

/// Those of samples.node that lie in a row of the grid of nodes, which is `columns` wide.
[[nodiscard]] std::span<const std::int32_t> nodes_of_row(const MotionSamples& samples, int columns, int node_row);

/// The sampled pixels of row v of an image of that width.
[[nodiscard]] GatheredRuns runs_of_row(const MotionSamples& samples, int width, int v);

/// Every second node of an image, no pixel of them used yet.
void place_samples(int width, int height, MotionSamples& out);

/// Of mode T's closure residual, polarity undone (closure.hpp); shared: rho. max_residual: of B.
void take_samples(const PhaseMaps& maps, const PolarityMaps& polarity, float black_dn, float max_residual,
                  MotionSamples& out);

/// The same about motion and light known so far; maps and polarity as in the call above, which `out` remembers.
void take_samples(const PhaseMaps& maps, const PolarityMaps& polarity, const BurstErrors& known, float black_dn,
                  float max_residual, MotionSamples& out);

/// The sampled pixels of an image row, in their order: residuals about a motion known so far, and their columns; NaN
/// where a pixel says nothing.
struct SampleRow {
  const float *residual, *rate, *light, *shared;
  const float *known_rate, *known_light;
  const float *modulation, *open;  ///< B; 1 where not rejected, else 0
};

/// Those of row v, where it is sampled; max_residual: of B; width: of the image.
void take_sample_row(int width, int v, const SampleRow& row, float max_residual, MotionSamples& out);

/// Columns of eps and of dA/A for the six unknowns (V, W) at each sampled node, [k * nodes + n]; 0 where a node's slope
/// is unknown or too steep, and counts 0 there, else 1.
struct MotionColumns {
  std::vector<float> rate, light, counts;
  std::vector<float> by_node;  ///< the same columns, [2 * kColumnLanes * n + k] of eps, kColumnLanes further on of dA/A
};
inline constexpr std::size_t kColumnLanes = 8;  ///< six and two of 0

struct MotionEquations {
  std::array<std::array<double, 8>, 7> left{};  ///< upper triangle and some more; column 7 unused
  std::array<double, 8> right{};
  double squares = 0, pixels = 0;
};

}  // namespace enamel::algo
