// The loops of measure_cut_costs and of the residues over one row. Private to pipeline/decode.
#pragma once

#include <cstddef>
#include <cstdint>

#include "pipeline/decode/unwrap/cut_costs.hpp"
#include "pipeline/decode/unwrap/flood_rows.hpp"
#include "pipeline/decode/unwrap/link_rows.hpp"

namespace enamel::pipeline {

/// Differences along one line: of the link before, of this one, of the next; kInvalidDifference where there is none.
struct LineOfDifferences {
  const float *before, *here, *after;
};

/// Of links from each pixel of the row to the one `step` pixels on.
void cut_cost_row(const PixelRow& r, std::ptrdiff_t step, std::size_t count, const LineOfDifferences& line, float slope,
                  const CutConfig& config, std::uint8_t* cost);

/// Turns gained where the phase, less the carrier, wraps; 0 where the difference is invalid.
void wrap_row(const PixelRow& r, std::ptrdiff_t step, std::size_t count, const float* difference, std::int8_t* wraps);

/// Sum of the turns round each quad, clockwise from its upper left pixel.
void residue_row(const std::int8_t* east, const std::int8_t* east_below, const std::int8_t* south, std::size_t count,
                 std::uint8_t* out);

/// 1 where one of a quad's pixels is invalid.
void torn_row(const std::uint8_t* valid, const std::uint8_t* below, std::size_t count, std::uint8_t* out);

/// A row's links to the right, from pixel 0 on; pixel -1 exists and is margin.
struct CutRow {
  const std::uint8_t* valid;
  const std::int8_t* wraps;
  const std::uint8_t* cost;
  const std::int16_t* cut;
};

/// Where runs of pixels that hang together by whole links begin, or go on on another wrap count (flood_rows.hpp).
void mark_segments(const CutRow& row, std::size_t width, std::uint8_t* marks);

}  // namespace enamel::pipeline
