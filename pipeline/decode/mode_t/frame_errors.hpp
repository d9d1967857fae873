// Errors that single frames make: one frame brighter than the others, one shifted a little against its nominal place.
// With C = (I0-I2)/2 and S = (I3-I1)/2 of a four-frame solution, any such errors move the circle (C, S) = B (cos, sin)
// to a displaced ellipse, to first order
//   C = B (cos + k cos + l sin) + a A,     S = B (sin + l cos - k sin) + b A
// (plus a rotation, a constant phase that nothing inside the burst shows). a, b come from brightness and make an error
// of one period a fringe, k, l from brightness or shift and make one of two. Neither shows in the closure residual
// alone: there brightness and motion look alike. But both print fringes on the modulation, and B/A is a property of the
// surface's matter and of focus: it knows nothing of the fringes. So
//   |(C, S)|/A = B/A (1 + k cos 2phi + l sin 2phi) + a cos phi + b sin phi
// is solved for a, b, k, l by least squares, each pixel against the means of the fringe around it, so that B/A may be
// anything there; texture and edges are left out by what they leave unexplained. The measured A is rippled by the same
// frames: by how much of C and of S the same fit tells first, with A in place of |(C, S)|/A.
#pragma once

#include <span>

#include "pipeline/decode/mode_t/polarity.hpp"

namespace enamel::pipeline {

struct FrameErrors {
  double offset_cos = 0, offset_sin = 0;  ///< a, b: of the mean intensity above black
  double squeeze = 0, shear = 0;          ///< k, l
  double pixels = 0;                      ///< that the estimate rests on; 0: none was possible
};

struct FrameErrorConfig {
  /// chosen: by judgement, the captured plaster in view (docs/notes/decode-attempts.md, ripple).
  int rounds = 4;  ///< the model is first order; each round takes what the one before left
  double min_pixels = 5000;
};

/// Of a four-frame solution without flips (apply_polarity with all signs +1), where code_dn is the closure residual.
/// spans: in row order, fringes across the rows; half of a fringe is as long as the spans that are whole cells, and
/// without such spans there is no estimate. Estimates and removes: rewrites cosine_dn, sine_dn, modulation_dn,
/// phase_rad of the spans' pixels. The phase's wrap count is kept: phases may leave [-pi, pi) a little.
FrameErrors correct_frame_errors(std::span<const CellSpan> spans, const PolarityMaps& polarity, double black_dn,
                                 const FrameErrorConfig& config, PhaseMaps& maps);

}  // namespace enamel::pipeline
