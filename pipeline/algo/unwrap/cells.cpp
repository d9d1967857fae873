#include "pipeline/algo/unwrap/cells.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

/// Projector blur rounds the kink of frame 3 at a flip by up to this share of B (blur of 1.9 px in a period of 24).
constexpr float kBlurError = 0.2F;
constexpr float kNoiseOfCode = 3;     ///< var(D -+ S3) is 4 sigma^2 for b = +1, 2 sigma^2 for b = -1
constexpr float kRangeSlack = 0.25F;  ///< fringes: the bounds are taken at a piece's middle, its ends reach that far

struct Sums {
  float dot = 0, energy = 0, noise = 0, blur = 0;
};

void measure_code(const PhaseMaps& phase, const NoiseModel& noise, std::size_t at, Piece& p) {
  Sums s;
  for (std::size_t i = at + static_cast<std::size_t>(p.begin); i < at + static_cast<std::size_t>(p.end); ++i) {
    const float d = phase.code_dn[i], s3 = phase.sine_dn[i];
    if (!(d == d)) continue;
    const float e = s3 * s3;
    s.dot += d * s3;
    s.energy += e;
    s.noise += e * noise.variance(phase.mean_dn[i]);
    s.blur += phase.modulation_dn[i] * (s3 < 0 ? -s3 : s3);
  }
  if (!(s.energy > 1e-3F)) return;
  const float blur = kBlurError * s.blur / s.energy;
  p.code = s.dot / s.energy;
  p.code_variance = kNoiseOfCode * s.noise / (s.energy * s.energy) + blur * blur;
}

void measure_bounds(const PhaseMaps& phase, const FloodMaps& flood, const PhaseBounds& bounds, std::size_t at,
                    Piece& p) {
  const std::size_t i = at + static_cast<std::size_t>((p.begin + p.end) / 2);
  const float a = bounds.near_rad[i], b = bounds.far_rad[i];
  const float phi = phase.phase_rad[i] + kTwoPiF * flood.turn[i];
  p.low = static_cast<std::int32_t>(std::ceil((std::min(a, b) - phi) / kTwoPiF - kRangeSlack));
  p.high = static_cast<std::int32_t>(std::floor((std::max(a, b) - phi) / kTwoPiF + kRangeSlack));
}

/// Index of the candidate among [first, last) that shares most linked columns with `p`; -1 when none shares any.
std::int32_t best_overlap(const std::vector<Piece>& pieces, const Piece& p, std::size_t first, std::size_t last,
                          const std::uint8_t* south) {
  std::int32_t best = -1, most = 0;
  for (std::size_t k = first; k < last; ++k) {
    const Piece& o = pieces[k];
    if (o.end <= p.begin) continue;
    if (o.begin >= p.end) break;
    if (o.component != p.component || o.cell != p.cell) continue;
    std::int32_t shared = 0;
    for (std::int32_t u = std::max(o.begin, p.begin); u < std::min(o.end, p.end); ++u) shared += south[u];
    if (shared > most) most = shared, best = static_cast<std::int32_t>(k);
  }
  return best;
}

/// Links pieces of two neighbouring rows: a in [a0, b0), b in [b0, end), south links of the upper row.
void link_rows(std::vector<Piece>& pieces, std::size_t a0, std::size_t b0, std::size_t end, const std::uint8_t* south) {
  std::size_t from = a0;
  for (std::size_t k = b0; k < end; ++k) {
    while (from < b0 && pieces[from].end <= pieces[k].begin) ++from;
    pieces[k].up = best_overlap(pieces, pieces[k], from, b0, south);
  }
  from = b0;
  for (std::size_t k = a0; k < b0; ++k) {
    while (from < end && pieces[from].end <= pieces[k].begin) ++from;
    pieces[k].down = best_overlap(pieces, pieces[k], from, end, south);
  }
}

}  // namespace

void find_pieces(const PhaseMaps& phase, const NoiseModel& noise, const LinkMaps& links, const FloodMaps& flood,
                 const PhaseBounds& bounds, std::vector<Piece>& pieces) {
  pieces.clear();
  const auto width = static_cast<std::size_t>(phase.phase_rad.width());
  std::size_t above = 0;
  for (int v = 0; v < phase.phase_rad.height(); ++v) {
    const std::size_t at = static_cast<std::size_t>(v) * width, first = pieces.size();
    bool open = false;  // does the last piece of the list end at the pixel before u
    for (std::size_t u = 0; u < width; ++u) {
      const std::size_t i = at + u;
      if (flood.component[i] < 0) {
        open = false;
        continue;
      }
      const int turn = flood.turn[i];
      const int cell = 2 * turn - (phase.phase_rad[i] < 0 ? 1 : 0);
      bool joined = open && links.east[i - 1] != 0 && flood.component[i - 1] == flood.component[i];
      if (joined) {
        const float d = phase.phase_rad[i] - phase.phase_rad[i - 1];
        const int step = (d < -kPiF ? 1 : 0) - (d > kPiF ? 1 : 0);
        joined = turn == flood.turn[i - 1] + step;  // else two paths of the flood disagree here
      }
      if (!joined || pieces.back().cell != cell) {
        const auto x = static_cast<std::int32_t>(u);
        pieces.push_back({v, x, x, flood.component[i], cell, -1, -1, 0, -1, joined});
      }
      pieces.back().end = static_cast<std::int32_t>(u) + 1;
      open = true;
    }
    for (std::size_t k = first; k < pieces.size(); ++k) {
      measure_code(phase, noise, at, pieces[k]);
      measure_bounds(phase, flood, bounds, at, pieces[k]);
    }
    if (v > 0) link_rows(pieces, above, first, pieces.size(), &links.south[at - width]);
    above = first;
  }
}

}  // namespace enamel::algo
