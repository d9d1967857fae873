// Segments: runs of linked pixels of one row within one half fringe. The absolute order is looked for segment by
// segment, not pixel by pixel; what the code says about a segment is measured by its mode's evidence
// (code_evidence.hpp).
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/decode/unwrap/flood.hpp"
#include "pipeline/decode/unwrap/segment_rows.hpp"

namespace enamel::pipeline {

/// What lies between a run of pixels and the one before it in its row. Along a row, the projector's columns come in
/// order unless something thin stands before the surface. Where the gap is a shadow, both its ends lie on one ray of
/// light, the one that grazes the edge that casts it: Phi is the same at both.
struct Gap {
  std::int32_t lean = 0;  ///< least (rise > 0) or most difference of the runs' shifts that keeps the order
  std::int8_t rise = 0;   ///< +1: Phi rises along rows; -1: it falls; 0: nothing before, or the same run without a step
  bool contact = false;   ///< dark, and at the difference `lean` Phi is the same at both ends
};

struct Segment {
  std::int32_t row = 0, begin = 0, end = 0;  ///< pixels begin … end-1 of the row
  std::int32_t component = -1;
  std::int32_t cell = 0;            ///< floor(Phi/pi) of the flood's Phi; absolute cell = cell + 2*shift
  std::int32_t up = -1, down = -1;  ///< the same surface and cell in the rows above and below, no step between
  std::int32_t low = 0, high = -1;  ///< shifts that the depth range allows
  bool joined = false;              ///< continues the run of the segment before it in the list ...
  bool kink = false;  ///< ... but across a step: that step plus a jump of 2 pi would look the same; or a cut
  Gap gap;            ///< before this segment; of its run's first and of those across a step
  float first_rad = 0, last_rad = 0;  ///< the flood's Phi at pixels begin and end-1
};

/// The part of a segment whose code is trusted, less trim_px at a run's ends, where blur and motion mix frames of two
/// surfaces or of light and shadow; nothing at the borders of a picture `width` wide, where the view ends and not the
/// surface. Empty when end <= begin.
struct SegmentCore {
  std::int32_t begin = 0, end = 0;
};
[[nodiscard]] SegmentCore core_of(const std::vector<Segment>& segments, std::size_t k, std::int32_t trim_px,
                                  std::int32_t width) noexcept;

/// Phase at the two ends of the depth range, per pixel, rad, absolute.
struct PhaseBounds {
  const float* near_rad = nullptr;
  const float* far_rad = nullptr;
};

struct SegmentList {
  std::vector<Segment> segments;  ///< in row order

  struct Work {
    Map<float> unwrapped;        ///< flood's Phi; NaN outside all components
    std::vector<float> heights;  ///< of steps, a row's
    std::vector<float> shade_means;
    std::vector<std::uint8_t> borders, marks;  ///< PixelBorder and PixelMark, a row's
    std::vector<BorderColumn> border;          ///< between two rows
    std::vector<float> most;  ///< columns linked to the best neighbour so far, of each segment of two rows
  } work;
};

/// cuts: where the code shows a jump that the phase does not (code_steps.hpp), of the image's size; empty: unknown.
void find_segments(const PhaseMaps& phase, const LinkMaps& links, const FloodMaps& flood, const PhaseBounds& bounds,
                   const Map<std::uint8_t>& cuts, SegmentList& out);

}  // namespace enamel::pipeline
