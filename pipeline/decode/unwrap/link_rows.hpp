// The loops of compute_links over one row. Private to pipeline/decode.
#pragma once

#include "pipeline/decode/unwrap/links.hpp"

namespace enamel::pipeline {

inline constexpr float kInvalidDifference = 10;  ///< layout: any wrapped difference is below pi

struct PixelRow {
  const float* phase;
  const float* sigma;
  const float* carrier;
  const PixelReject* reject;
};

/// Wrapped difference to the neighbour `step` pixels on, less the carrier; kInvalidDifference beside an invalid pixel.
void difference_row(const PixelRow& r, std::ptrdiff_t step, std::size_t count, float* out);

/// 1 where the difference is one that a surface of up to `slope` (rad a pixel) can show, and noise.
void link_row(const PixelRow& r, std::ptrdiff_t step, std::size_t count, const float* difference, float slope,
              const LinkConfig& config, std::uint8_t* link);

/// Modulation-Laplace, log scale; see compute_links. east and west are the same array, one pixel apart: east[-1]
/// exists.
void quality_row(const PixelRow& r, std::size_t width, const float* east, const float* south, const float* north,
                 std::uint8_t* out);

/// marks: 1 where a pixel and the one `step` further on are kNone or kEdge, but not linked; else 0.
void mark_cuts(const PixelReject* reject, std::ptrdiff_t step, const std::uint8_t* link, std::size_t count,
               std::uint8_t* marks);

/// kNone becomes kEdge where the modulation is under half of the largest at -+ side, `up` and `down`.
void half_lit_row(const float* modulation, std::ptrdiff_t side, std::ptrdiff_t up, std::ptrdiff_t down,
                  std::size_t count, PixelReject* reject);

}  // namespace enamel::pipeline
