#include "pipeline/decode/steps/translucency.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/decode/phase/row_memory.hpp"
#include "pipeline/decode/steps/chosen.hpp"

namespace enamel::pipeline {
namespace {

/// Contrast of light from inside alone: with less, something else is amiss. derived: M at a period of 1 mm.
constexpr float kLeastContrast = 0.155F * kPlasterContrast;
/// k of enamel at a period of 1 mm. derived: M = 0.155, d = 0.106 mm by photon Monte Carlo.
constexpr float kEnamel_mm = 0.106F * 0.155F / (1 - 0.155F);

/// Light and contrast around each pixel of a row, over measured pixels.
class ContrastRows {
 public:
  ContrastRows(const PhaseMaps& maps, float black_dn, float projected)
      : maps_(maps), black_dn_(black_dn), per_projected_(1 / projected) {
    const auto padded = static_cast<std::size_t>(maps.phase_rad.width()) + 2 * kContrastHalf_px;
    light_ = RowMemory(padded), fringe_ = RowMemory(padded);
  }

  /// ratio: one a pixel, over what was projected; 0 where nothing is measured.
  void row(int v, RowMemory& ratio) {
    const int height = maps_.phase_rad.height(), width = maps_.phase_rad.width();
    std::fill_n(light_.data(), light_.size(), 0.0F), std::fill_n(fringe_.data(), fringe_.size(), 0.0F);
    for (int y = std::max(0, v - kContrastHalf_px); y <= std::min(height - 1, v + kContrastHalf_px); ++y) add(y);
    const float* __restrict light = light_.data(), * __restrict fringe = fringe_.data();
    float* __restrict out = ratio.data();
    const float scale = per_projected_;
    for (int u = 0; u < width; ++u) {
      float a = 0, b = 0;
      for (int k = 0; k <= 2 * kContrastHalf_px; ++k) a += light[u + k], b += fringe[u + k];
      out[u] = select(a > 0, b * scale / a, 0);
    }
  }

 private:
  void add(int y) {
    const std::size_t at = maps_.phase_rad.index(0, y);
    const auto width = static_cast<std::size_t>(maps_.phase_rad.width());
    const float* __restrict mean = &maps_.mean_dn[at], * __restrict modulation = &maps_.modulation_dn[at];
    const PixelReject* __restrict reject = &maps_.reject[at];
    float* __restrict light = light_.data() + kContrastHalf_px, * __restrict fringe = fringe_.data() + kContrastHalf_px;
    const float black_dn = black_dn_;
    for (std::size_t u = 0; u < width; ++u) {
      const bool measured = (reject[u] == PixelReject::kNone) | (reject[u] == PixelReject::kRelative);
      light[u] += select(measured, mean[u] - black_dn, 0);
      fringe[u] += select(measured, modulation[u], 0);
    }
  }

  const PhaseMaps& maps_;
  float black_dn_, per_projected_;
  RowMemory light_, fringe_;
};

/// Share of the measured pixels that look translucent, on every fourth row.
double translucent_share(const PhaseMaps& maps, ContrastRows& contrast, RowMemory& ratio) {
  constexpr int kAskedRowStep = 4;  // layout: tens of thousands of pixels are asked
  std::size_t translucent = 0, measured = 0;
  for (int v = 0; v < maps.phase_rad.height(); v += kAskedRowStep) {
    contrast.row(v, ratio);
    const PixelReject* reject = &maps.reject[maps.phase_rad.index(0, v)];
    for (std::size_t u = 0; u < ratio.size(); ++u) {
      const bool counts = reject[u] == PixelReject::kNone && ratio[u] > 0;
      measured += counts ? 1U : 0U;
      translucent += counts && ratio[u] < kTranslucent ? 1U : 0U;
    }
  }
  return measured == 0 ? 0 : static_cast<double>(translucent) / static_cast<double>(measured);
}

struct RowSum {
  double depth_mm = 0;
  std::size_t count = 0;
};

/// One row: apparent depth to phase by the ray's own slope, where the pixel lies or, while its order is open, at the
/// middle of the range.
RowSum undo_row(const SeenPattern& seen, const RefinedPhase& refined, const RowMemory& ratio, int v, bool correct,
                PhaseMaps& phase) {
  const RayDepth& rays = seen.rays;
  const ApparentDepthField& field = seen.optics.field;
  const auto [middle, linear, square] = field.row(v);
  const std::size_t at = phase.phase_rad.index(0, v);
  RowSum sum;
  for (std::size_t u = 0; u < ratio.size(); ++u) {
    const std::size_t i = at + u;
    const bool placed = phase.reject[i] == PixelReject::kNone;
    if (!(placed || phase.reject[i] == PixelReject::kRelative) || ratio[u] <= 0 || ratio[u] >= kOpaque) continue;
    const float absolute = phase.phase_rad[i] + kTwoPiF * static_cast<float>(refined.wraps[i]);
    const float at_rad = placed ? absolute : rays.phase_mid_rad[i];
    const float q = rays.inverse_depth(i, at_rad), slope = rays.inverse_depth_slope(i, at_rad);
    if (!(q > 0)) continue;
    const float facing_mm = apparent_depth_at_1mm(ratio[u]) * apparent_depth_growth(seen.optics.period_per_mm / q);
    const float s = field.column(u), depth_mm = facing_mm * (middle + s * (linear + s * square));
    const float shift_rad = depth_mm * q * q / slope, unsure_rad = static_cast<float>(kApparentDepthUnsure) * shift_rad;
    if (correct) phase.phase_rad[i] += shift_rad;
    if (correct) phase.sigma_rad[i] = std::sqrt(phase.sigma_rad[i] * phase.sigma_rad[i] + unsure_rad * unsure_rad);
    sum.depth_mm += static_cast<double>(depth_mm), ++sum.count;
  }
  return sum;
}

}  // namespace

float apparent_depth_at_1mm(float ratio) noexcept {
  const float sure = std::clamp((kOpaque - ratio) / (kOpaque - kTranslucent), 0.0F, 1.0F);
  return sure * kEnamel_mm * (kPlasterContrast / std::max(ratio, kLeastContrast) - 1);
}

float plaster_contrast(const PatternOptics& optics) noexcept { return kPlasterContrast * optics.contrast; }

/// derived: k by Monte Carlo is 6.2, 19.4, 67 um at 0.5, 1, 2 mm: p^1.72 within 5 %; here p^1.75, by roots.
float apparent_depth_growth(float period_mm) noexcept {
  return period_mm * period_mm / std::sqrt(std::sqrt(period_mm));
}

PatternOptics seen_through(const Waveform& wave, PatternOptics optics) noexcept {
  if (wave.is_cosine()) return optics;
  // Through an exponent of about 1.5; a tenth of the mean light at most, and roots give the same bits everywhere.
  const float level = std::max(0.0F, 1 - optics.contrast), darkest = level * std::sqrt(level);
  const auto lowest = static_cast<float>(-wave.at(-1).value);  // of F(cos phi), where cos phi = -1
  optics.contrast = std::clamp((1 - darkest) / std::max(lowest, 1 / kMostContrast), optics.contrast, kMostContrast);
  return optics;
}

void undo_translucency(const SeenPattern& seen, const TranslucencyConfig& config, const RefinedPhase& refined,
                       Sight& sight, PhaseMaps& phase) {
  RowMemory ratio(static_cast<std::size_t>(seen.rays.width));
  ContrastRows contrast(phase, seen.black_dn + sight.veil_dn, seen.optics.contrast);
  const double share = translucent_share(phase, contrast, ratio);
  sight.translucent_share = static_cast<float>(share);
  sight.apparent_depth_mm = 0;
  if (share < config.least_share) return;
  RowSum all;
  for (int v = 0; v < seen.rays.height; ++v) {
    contrast.row(v, ratio);
    const RowSum sum = undo_row(seen, refined, ratio, v, config.correct, phase);
    all.depth_mm += sum.depth_mm, all.count += sum.count;
  }
  if (all.count > 0) sight.apparent_depth_mm = static_cast<float>(all.depth_mm / static_cast<double>(all.count));
}

}  // namespace enamel::pipeline
