// Numbers of the steps that no law gives; limits of the gates stand in decode_gates.hpp. Private to pipeline/decode.
#pragma once

#include <cstdint>

namespace enamel::pipeline {

/// Of a frame's spread over its noise: a frame below the first shows no picture where another above the second shows
/// one. chosen: by judgement. What varies by its noise alone has 1.
inline constexpr double kBlankSigmas = 2, kPictureSigmas = 6;
/// Noise of two pixels that the carrier's step between them must exceed for its sign: nineteen of twenty are right; and
/// the largest step, of which a slanted surface may show three times as much. chosen: by judgement.
inline constexpr double kSignSigmas = 2, kMostStep_rad = 0.8;
/// On either side of a jump. chosen: on 50 rows of teeth (docs/notes/decode-attempts.md, orders). One that blur mixes,
/// one that the code may be off by.
inline constexpr std::int32_t kMixed_px = 2;
/// Segments whose code is another one, in a region that is judged by it. chosen: by judgement. Two are a glint.
inline constexpr std::size_t kFewestLiars = 3;
/// Contrast of plaster over that of the pattern as projected: what blur and ambient light leave of it.
/// chosen: on rendered planes, balls and jaws of six units: 0.87 to 0.94 over the depth range.
inline constexpr float kPlasterContrast = 0.92F;
/// Against what was projected: full correction below, none above. chosen: by judgement, between teeth (0.2 to 0.45)
/// and plaster.
inline constexpr float kTranslucent = 0.5F, kOpaque = 0.75F;
/// chosen: by judgement. Half the window that contrast is averaged over: the noise of one pixel's would be half of it.
inline constexpr int kContrastHalf_px = 2;
/// Of a gamma's fringes: their largest contrast, 2 gamma/(gamma + 1) at 4. chosen: by judgement.
inline constexpr float kMostContrast = 1.6F;

/// Squares of the image by which the sight is judged: some 0.9 mm of a surface at mid-range; and the light of one, over
/// the noise of a pixel, from which on its contrast means anything. chosen: by judgement.
inline constexpr int kSightCell_px = 32;
inline constexpr double kLitSigmas = 3;
/// Of the image's cells: light and contrast of fewer tell nothing of the whole. chosen: by judgement.
inline constexpr double kFewestLit = 0.33;
/// Frames of one surface have the same mean; of their light. chosen: on rendered jaws, teeth, balls and planes at 0 to
/// 25 mm/s show up to 0.017, a lamp at 100 Hz that adds a third of the light and swings by a third of itself 0.04 to
/// 0.11.
inline constexpr double kFlicker = 0.03;
/// A cell that is lit and has no fringes. chosen: on rendered mouths, where teeth and gum keep 0.15 and more of the
/// fringes' contrast.
inline constexpr double kUnlitContrast = 0.08;
/// Of the image's cells: so many without fringes are a veil. chosen: by judgement.
inline constexpr double kVeiledCells = 0.02;
/// Spread of a veil over its mean below which it lies on the window. chosen: by judgement; a lamp is shaded by form and
/// colour.
inline constexpr double kEvenVeil = 0.1;
/// Of the median light, and the share of the contrast's variation that one veil explains. chosen: on rendered plaster,
/// which shows up to 0.02 of a veil, where light inside or colour vary less than 0.92 is explained.
inline constexpr double kLeastVeil = 0.12, kVeilExplained = 0.95;
/// Contrast over that of most cells: mirror light keeps all of it where light inside takes most.
/// chosen: on rendered mouths: teeth and gum have 0.2 to 0.45, metal 0.65 and more.
inline constexpr double kMirrorContrast = 0.62, kTissueContrast = 0.5;
/// Cells of one crown: 8 mm across are 64 of them. chosen: on rendered mouths: glints on teeth make up to 20.
inline constexpr std::size_t kMetalCells = 24;
/// Glare worth a word: of the lit pixels. chosen: on rendered mouths: dry teeth show up to 0.0006 at a time.
inline constexpr double kGlareOfLit = 0.002;
/// Of a cell's pixels: so many at full scale are glare. chosen: by judgement.
inline constexpr double kGlareOfCell = 0.02;

}  // namespace enamel::pipeline
