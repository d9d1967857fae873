// The pixels that the motion is judged by: every second one of every second row about every second node. Private to
// pipeline/decode.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/decode/motion/gathered_runs.hpp"

namespace enamel::pipeline {

/// layout: samples lie so in memory.
inline constexpr std::size_t kNodePixels = 16;
inline constexpr std::size_t kNodeLanes = 8;  ///< nodes are padded to a multiple of it by ones without pixels

/// Columns of the residual y of each pixel for eps, dA/A and a number that all pixels share (motion_view.hpp); pixel p
/// of node n at place(p, n). All 0 where a pixel says nothing.
struct MotionSamples {
  std::size_t nodes = 0;
  std::vector<std::int32_t> node;          ///< index in the grid of nodes
  std::vector<float> rate, rate_per_rate;  ///< column of eps at eps = 0, and its slope over eps: second order
  std::vector<float> light, shared, residual, used;
  std::vector<float> row;  ///< scratch

  /// kNodeLanes nodes side by side, all their pixels one after the other, then the next nodes.
  [[nodiscard]] static std::size_t place(std::size_t pixel, std::size_t node) noexcept {
    return (node / kNodeLanes * kNodePixels + pixel) * kNodeLanes + node % kNodeLanes;
  }
};

inline constexpr int kPixelStep = 2;  ///< layout: pixel p of a node: of each row kNode_px / kPixelStep

/// Column of a node at which its pixels in image row v begin: rows take turns.
[[nodiscard]] constexpr int first_column(int v) noexcept { return v / kPixelStep % kPixelStep; }

/// Those of samples.node that lie in a row of the grid of nodes, which is `columns` wide.
[[nodiscard]] std::span<const std::int32_t> nodes_of_row(const MotionSamples& samples, int columns, int node_row);

/// The sampled pixels of row v of an image of that width.
[[nodiscard]] GatheredRuns runs_of_row(const MotionSamples& samples, int width, int v);

/// Every second node of an image, no pixel of them used yet.
void place_samples(int width, int height, MotionSamples& out);

/// The sampled pixels of an image row, in their order: residuals about a motion known so far, and their columns; NaN
/// where a pixel says nothing.
struct SampleRow {
  const float *residual, *rate, *light, *shared;
  const float *known_rate, *known_light;
  const float *modulation, *open;  ///< B; 1 where not rejected, else 0
};

/// Those of row v, where it is sampled; max_residual: of B; width: of the image.
void take_sample_row(int width, int v, const SampleRow& row, float max_residual, MotionSamples& out);

/// What the sampled pixels of an image row say, in their order (MotionSamples); 0 where they say nothing.
struct SampledResiduals {
  float *rate, *rate_per_rate, *light, *shared, *residual, *used;
};

/// Memory for a row of `count` pixels; valid until the next call.
[[nodiscard]] SampledResiduals sampled_residuals(std::size_t count, MotionSamples& out);

/// Puts row v, where it is sampled, to its nodes. second_order: rate_per_rate is filled.
void put_sampled_residuals(int width, int v, const SampledResiduals& row, bool second_order, MotionSamples& out);

/// Columns of eps and of dA/A for the six unknowns (V, W) at each sampled node, [k * nodes + n]; 0 where a node's slope
/// is unknown or too steep, and counts 0 there, else 1.
struct MotionColumns {
  std::vector<float> rate, light, counts;
  std::vector<float> by_node;  ///< the same columns, [2 * kColumnLanes * n + k] of eps, kColumnLanes further on of dA/A
};
inline constexpr std::size_t kColumnLanes = 8;  ///< layout: six and two of 0

struct MotionEquations {
  std::array<std::array<double, 8>, 7> left{};  ///< upper triangle and some more; column 7 unused
  std::array<double, 8> right{};
  double squares = 0, pixels = 0;
};

}  // namespace enamel::pipeline
