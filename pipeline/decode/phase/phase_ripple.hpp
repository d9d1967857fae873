// Self-calibration of the phase error from harmonics of the projected waveform ("linear-sinusoidal", docs/decode.md
// §6). True phase is spread evenly over whole fringes, so measured phase folded by 2 pi/N must be too: the map that
// levels its distribution is the correction. With the distribution's moments C_m = <cos N m phi>, S_m = <sin N m phi>
// over measured phase, its integral is, term by term,
//   phi_true = phi - sum_m 2/(N m) (S_m cos N m phi - C_m sin N m phi).
// The argument is the *measured* phase: no iteration, and only truncation of the sum is an approximation. S_m is zero
// for symmetric waveforms; a projector whose bit planes are not symmetric in time has both.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "pipeline/decode/phase/cell_span.hpp"
#include "pipeline/decode/phase/chosen.hpp"
#include "pipeline/decode/phase/phase.hpp"

namespace enamel::pipeline {

/// Sums over any number of bursts of one projector and pitch; add what belongs together, in a fixed order.
struct PhaseMoments {
  int steps = 4;  ///< N
  double pixels = 0;
  std::array<double, kRippleTerms> cosines{}, sines{};

  void add(const PhaseMoments& other) noexcept;
};

/// Amplitudes in rad of cos N m phi and sin N m phi, m = 1 … kRippleTerms.
struct PhaseRipple {
  int steps = 4;
  std::array<double, kRippleTerms> cosine{}, sine{};

  [[nodiscard]] double error_rad(double phase_rad) const noexcept;
};

/// Of four-step phase, over spans that cover their half fringe from end to end: part of a fringe is not evenly spread.
/// Nor is a half fringe where they grow along the row, as on a curved surface: pixels crowd towards its longer
/// neighbour. What that adds to S_m is taken off, by the lengths of the spans on both sides. spans: in row order, cells
/// absolute or at least in order. Of many pixels every third row. From C and S, turned by what phase_rad is off their
/// angle: no trigonometry.
[[nodiscard]] PhaseMoments phase_moments(std::span<const CellSpan> spans, const PhaseMaps& maps);

/// The same, the pixels of each span times its weight: how the moments go with something else that is known of a place.
/// One weight a span, because a weight that changed along a fringe would be taken for ripple. `pixels` counts them all.
using WeighSpan = std::function<float(const CellSpan& span)>;
[[nodiscard]] PhaseMoments phase_moments(std::span<const CellSpan> spans, const PhaseMaps& maps,
                                         const WeighSpan& weigh);

/// Visits the spans that these ask, in order.
void each_asked_span(std::span<const CellSpan> spans, const std::function<void(const CellSpan& span)>& visit);

/// For bare phases that cover whole fringes.
[[nodiscard]] PhaseMoments phase_moments(std::span<const float> phase_rad, int steps = 4);

/// terms <= kRippleTerms. No pixels: no ripple.
[[nodiscard]] PhaseRipple level(const PhaseMoments& moments, std::size_t terms = kRippleTerms);

/// Variance of an amplitude of term m = 1 … kRippleTerms that noise alone shows in so many pixels, for phases at random
/// and four steps: 1/(2 m sqrt(2 pixels)) squared. 1 without pixels.
[[nodiscard]] double amplitude_variance(std::size_t m, double pixels) noexcept;

/// Each term less what noise alone may show in so few pixels: times a^2/(a^2 + amplitude_variance).
[[nodiscard]] PhaseRipple shrink(const PhaseRipple& ripple, const PhaseMoments& moments);

/// Subtracts the error. Phases may leave [-pi, pi) a little.
void correct_phase(const PhaseRipple& ripple, std::span<float> phase_rad);

}  // namespace enamel::pipeline
