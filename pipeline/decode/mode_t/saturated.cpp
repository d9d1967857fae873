#include "pipeline/decode/mode_t/saturated.hpp"

#include <cstring>
#include <limits>

#include "pipeline/decode/mode_t/closure_rows.hpp"
#include "pipeline/decode/mode_t/three_frames.hpp"
#include "pipeline/decode/phase/frame_rows.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// The saturated frame of a pixel with but one, else 4. Frames: raw DN.
std::size_t only_saturated(const Frames& dn, float saturated_dn) {
  std::size_t missing = 4, count = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (dn[k] >= saturated_dn) missing = k, ++count;
  }
  return count == 1 ? missing : 4;
}

/// What the three frames are worth, by the mask's own rules.
bool solve_pixel(const Frames& dn, std::size_t missing, std::size_t i, const NoiseModel& noise,
                 const PhaseConfig& config, PhaseMaps& m) {
  Frames x{};
  for (std::size_t k = 0; k < 4; ++k) {
    if (noise.black_dn > 0 && dn[k] < 0.5F) return false;
    x[k] = dn[k] - noise.black_dn;
  }
  const FourStepPixel pixel = solve_without(missing, x);
  const float sigma = sigma_without(missing, pixel, x, noise), c = pixel.cosine, s = pixel.sine;
  if (!(sigma < config.max_sigma_rad)) return false;
  m.mean_dn[i] = pixel.mean + noise.black_dn;
  m.cosine_dn[i] = c;
  m.sine_dn[i] = s;
  m.code_dn[i] = missing == 1 ? s : kNan;
  m.modulation_dn[i] = root(c * c + s * s + 1e-6F);
  m.phase_rad[i] = atan2_poly(s, c);
  m.sigma_rad[i] = sigma;
  m.reject[i] = PixelReject::kNone;
  return true;
}

/// Of a pixel solved at rest, b = +1: what its frames were, the missing one as the others predict it.
Frames frames_of(const FourStepPixel& p) {
  return {p.mean + p.cosine, p.mean - p.sine, p.mean - p.cosine, p.mean + p.sine};
}

FourStepPixel pixel_at(const PhaseMaps& maps, std::size_t i, float black_dn) {
  return {maps.mean_dn[i] - black_dn, maps.cosine_dn[i], maps.sine_dn[i]};
}

/// Whether frame 3 is A + S throughout flip_full_rad around the absolute phase phi + 2 pi wraps.
bool is_plain(float phi, int wraps, const CellSigns& signs, float reach_rad) {
  const int cell = 2 * wraps - static_cast<int>(phi < 0);
  const float above = phi < 0 ? phi + kPiF : phi;  // distance to the cell's lower border
  return signs.at(cell) > 0 && (above >= reach_rad || signs.at(cell - 1) > 0) &&
         (kPiF - above >= reach_rad || signs.at(cell + 1) > 0);
}

}  // namespace

void solve_saturated(const BurstView& view, const NoiseModel& noise, const PhaseConfig& config, PhaseMaps& maps,
                     std::vector<SaturatedPixel>& out) {
  out.clear();
  const auto width = static_cast<std::size_t>(view.width);
  const float saturated_dn = config.saturation * noise.full_scale_dn;
  FrameRows rows;
  for (auto& row : rows) row.resize(width);
  for (std::size_t v = 0; v < static_cast<std::size_t>(view.height); ++v) {
    const PixelReject* reject = &maps.reject[v * width];
    if (std::memchr(reject, static_cast<int>(PixelReject::kSaturated), width) == nullptr) continue;
    load_row(view, v, rows);
    for (std::size_t u = 0; u < width; ++u) {
      if (reject[u] != PixelReject::kSaturated) continue;
      const Frames dn = {rows[0][u], rows[1][u], rows[2][u], rows[3][u]};
      const std::size_t missing = only_saturated(dn, saturated_dn), i = v * width + u;
      if (missing < 3 && solve_pixel(dn, missing, i, noise, config, maps))
        out.push_back({i, static_cast<std::uint8_t>(missing)});
    }
  }
}

void reject_parted(const std::vector<SaturatedPixel>& pixels, LinkMaps& links, Map<PixelReject>& reject) {
  const std::size_t width = static_cast<std::size_t>(reject.width()), n = reject.size();
  const auto cut = [&](std::size_t a, std::size_t b, const Map<std::uint8_t>& link) {
    return link[a] == 0 && reject[a] == PixelReject::kNone && reject[b] == PixelReject::kNone;
  };
  for (const SaturatedPixel& p : pixels) {
    const std::size_t i = p.index, u = i % width;
    const bool parted = (u + 1 < width && cut(i, i + 1, links.east)) || (u > 0 && cut(i - 1, i, links.east)) ||
                        (i + width < n && cut(i, i + width, links.south)) ||
                        (i >= width && cut(i - width, i, links.south));
    if (!parted) continue;
    reject[i] = PixelReject::kSaturated;
    unlink(links, i, width);
  }
}

void sort_out_saturated(const std::vector<SaturatedPixel>& pixels, const CellSigns& signs, const NoiseModel& noise,
                        const PolarityConfig& config, const Map<std::int16_t>& wraps, PhaseMaps& maps) {
  for (const SaturatedPixel& p : pixels) {
    const std::size_t i = p.index;
    maps.code_dn[i] = kNan;  // three frames for three unknowns: no residual
    if (maps.reject[i] != PixelReject::kNone) continue;
    if (!is_plain(maps.phase_rad[i], wraps[i], signs, config.flip_full_rad)) {
      maps.reject[i] = PixelReject::kSaturated;
      continue;
    }
    const FourStepPixel pixel = pixel_at(maps, i, noise.black_dn);
    maps.sigma_rad[i] = sigma_without(p.missing, pixel, frames_of(pixel), noise);
  }
}

void correct_saturated(const std::vector<SaturatedPixel>& pixels, const PolarityMaps& polarity,
                       const BurstErrors& errors, float black_dn, const PhaseMaps& maps,
                       std::vector<float>& phase_rad) {
  const int width = maps.phase_rad.width();
  ErrorRows rows(errors, black_dn, width);
  RowErrors e;
  int row = -1;
  phase_rad.clear();
  for (const SaturatedPixel& p : pixels) {
    const std::size_t i = p.index, u = i % static_cast<std::size_t>(width);
    const int v = static_cast<int>(i / static_cast<std::size_t>(width));
    if (v != row) e = rows.at(polarity, v), row = v;
    const FourStepPixel rest = pixel_at(maps, i, black_dn);
    const FourStepPixel at = solve_without(p.missing, frames_of(rest), e.change(u), e.harmonic[u]);
    phase_rad.push_back(maps.phase_rad[i] + atan2_poly(at.sine * rest.cosine - at.cosine * rest.sine,
                                                       at.cosine * rest.cosine + at.sine * rest.sine));
  }
}

}  // namespace enamel::pipeline
