#include "tests/support/blocks_scene.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <vector>

#include "pipeline/decode/phase/phase_ripple.hpp"
#include "pipeline/decode/unwrap/flood.hpp"
#include "tests/support/fold_error.hpp"
#include "tests/support/fringe_set.hpp"

namespace enamel::test {
namespace {

constexpr float kPi = 3.14159265F;
constexpr float kMinModulation_dn = 10, kNoise_dn = 1.5F;  // noise: from the flat parts of the white image
constexpr int kMinPiece_px = 64;

/// Three-step phase of images 0 … 2 as the set's author defines it; the noise of three frames is 0.816 sigma/B.
void solve(const FringeImages& set, pipeline::PhaseMaps& m) {
  m.resize(set.width, set.height);
  for (std::size_t i = 0; i < m.phase_rad.size(); ++i) {
    const auto i0 = static_cast<float>(set.images[0][i]), i1 = static_cast<float>(set.images[1][i]),
               i2 = static_cast<float>(set.images[2][i]);
    const float s = std::sqrt(3.0F) * (i0 - i2), c = 2 * i1 - i0 - i2;
    const float b = std::max(std::hypot(s, c) / 3, 1e-3F);
    m.phase_rad[i] = std::atan2(s, c);
    m.modulation_dn[i] = b;
    m.sigma_rad[i] = 0.816F * kNoise_dn / b;
    m.reject[i] = b > kMinModulation_dn ? pipeline::PixelReject::kNone : pipeline::PixelReject::kDark;
  }
}

/// No calibration: the carrier is the median phase step of the image.
float median_step(const pipeline::PhaseMaps& m) {
  std::vector<float> steps;
  for (int v = 0; v < m.phase_rad.height(); ++v) {
    for (int u = 0; u + 1 < m.phase_rad.width(); ++u) {
      if (m.reject(u, v) == pipeline::PixelReject::kNone && m.reject(u + 1, v) == pipeline::PixelReject::kNone)
        steps.push_back(std::remainder(m.phase_rad(u + 1, v) - m.phase_rad(u, v), 2 * kPi));
    }
  }
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

double rms_of(const pipeline::PhaseRipple& ripple) {
  double sum = 0;
  for (std::size_t m = 0; m < pipeline::kRippleTerms; ++m)
    sum += 0.5 * (ripple.cosine[m] * ripple.cosine[m] + ripple.sine[m] * ripple.sine[m]);
  return std::sqrt(sum);
}

/// Distance, rad, of Phi (relative) to the middle of the pixel's cell: cell n of the code covers [n, n+1) fringes.
double to_middle(const pipeline::PhaseMaps& m, const pipeline::FloodMaps& f, const Map<std::int32_t>& cell,
                 std::size_t i) {
  const double absolute = static_cast<double>(m.phase_rad[i]) + 2 * std::numbers::pi * f.wraps[i];
  return 2 * std::numbers::pi * (cell[i] + 0.5) - absolute;
}

void judge(const pipeline::PhaseMaps& m, const pipeline::FloodMaps& f, const Map<std::int32_t>& cell,
           BlocksFigures& out) {
  std::map<std::int32_t, std::vector<std::size_t>> segments;
  for (std::size_t i = 0; i < m.phase_rad.size(); ++i)
    if (f.component[i] >= 0) segments[f.component[i]].push_back(i);
  std::size_t largest = 0, near = 0, literal = 0;
  for (const auto& [component, pixels] : segments) {
    if (pixels.size() < kMinPiece_px) continue;
    std::vector<double> offsets;
    for (const std::size_t i : pixels) offsets.push_back(to_middle(m, f, cell, i));
    const auto middle = offsets.begin() + static_cast<std::ptrdiff_t>(offsets.size() / 2);
    std::nth_element(offsets.begin(), middle, offsets.end());
    const double shift = 2 * std::numbers::pi * std::round(*middle / (2 * std::numbers::pi));
    for (const std::size_t i : pixels) {
      const double off = std::abs(to_middle(m, f, cell, i) - shift);
      literal += off <= std::numbers::pi ? 1U : 0U;
      near += off <= std::numbers::pi + 0.6 ? 1U : 0U;
    }
    out.solved_px += pixels.size();
    largest = std::max(largest, pixels.size());
  }
  const auto n = static_cast<double>(std::max<std::size_t>(out.solved_px, 1));
  out.orders_equal = static_cast<double>(near) / n;
  out.orders_literal = static_cast<double>(literal) / n;
  out.largest_share = static_cast<double>(largest) / n;
}

/// Fringe of a pixel by its Gray cell; nothing within 0.6 rad of the cell's borders, where code and phase may part.
std::optional<long> fringe_by_code(const pipeline::PhaseMaps& m, const Map<std::int32_t>& cell, std::size_t i) {
  // Cell n begins where the wrapped phase jumps, at pi: its middle has phase 0 modulo 2 pi.
  const double turns = cell[i] + 0.5 - static_cast<double>(m.phase_rad[i]) / (2 * std::numbers::pi);
  const double nearest = std::round(turns);
  if (std::abs(turns - nearest) > 0.5 - 0.6 / (2 * std::numbers::pi)) return std::nullopt;
  return std::lround(nearest);
}

double torn_links(const pipeline::PhaseMaps& m, const pipeline::LinkMaps& links, const Map<std::int32_t>& cell) {
  std::size_t judged = 0, torn = 0;
  for (std::size_t i = 0; i + 1 < m.phase_rad.size(); ++i) {
    if (links.east[i] == 0) continue;
    const auto here = fringe_by_code(m, cell, i), there = fringe_by_code(m, cell, i + 1);
    if (!here || !there) continue;
    const double d = static_cast<double>(m.phase_rad[i + 1]) - static_cast<double>(m.phase_rad[i]);
    const long wraps = d < -std::numbers::pi ? 1 : (d > std::numbers::pi ? -1 : 0);
    ++judged;
    torn += *there - *here != wraps ? 1U : 0U;
  }
  return judged > 0 ? static_cast<double>(torn) / static_cast<double>(judged) : 0;
}

}  // namespace

Result<BlocksFigures> measure_blocks(const std::string& folder) {
  std::vector<std::string> names = numbered("pat", 3, 3);  // 100 px period, that of the Gray code's cell
  for (const auto& more : {numbered("pat", 12, 5, 2), numbered("pat", 30, 2)})
    names.insert(names.end(), more.begin(), more.end());
  ENAMEL_TRY_ASSIGN(const FringeImages set, load_fringe_images(folder, names));
  pipeline::PhaseMaps maps;
  solve(set, maps);
  BlocksFigures out;
  std::vector<float> lit;
  Map<float> threshold(set.width, set.height);
  for (std::size_t i = 0; i < threshold.size(); ++i) {
    threshold[i] = 0.5F * (static_cast<float>(set.images[8][i]) + static_cast<float>(set.images[9][i]));
    if (maps.reject[i] == pipeline::PixelReject::kNone) lit.push_back(maps.phase_rad[i]);
  }
  out.lit_px = lit.size();
  const pipeline::PhaseRipple ripple = pipeline::level(pipeline::phase_moments(lit, 3));
  out.ripple_before = rms_of(ripple);
  pipeline::correct_phase(ripple, lit);
  out.ripple_after = rms_of(pipeline::level(pipeline::phase_moments(lit, 3)));
  for (std::size_t i = 0; i < maps.phase_rad.size(); ++i) {
    maps.phase_rad[i] = static_cast<float>(
        wrap_pi(static_cast<double>(maps.phase_rad[i]) - ripple.error_rad(static_cast<double>(maps.phase_rad[i]))));
  }

  const float step = median_step(maps);
  Map<float> carrier(set.width, set.height);
  for (int v = 0; v < set.height; ++v)
    for (int u = 0; u < set.width; ++u) carrier(u, v) = step * static_cast<float>(u);
  pipeline::LinkMaps links;
  // A slope may at most stop or double the fringes' run.
  pipeline::compute_links(maps, {carrier.pixels().data(), std::abs(step), std::abs(step)}, {}, links);
  pipeline::reject_edges(links, maps);
  pipeline::FloodMaps flooded;
  pipeline::flood(maps.phase_rad, links, flooded);
  const Map<std::int32_t> cell = decode_gray(set, 3, 5, threshold);
  judge(maps, flooded, cell, out);
  out.links_torn = torn_links(maps, links, cell);
  return out;
}

}  // namespace enamel::test
