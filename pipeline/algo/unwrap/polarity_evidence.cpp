#include "pipeline/algo/unwrap/polarity_evidence.hpp"

#include <algorithm>
#include <cmath>

namespace enamel::algo {
namespace {

/// Projector blur rounds the kink of frame 3 at a flip by up to this share of B (blur of 1.9 px in a period of 24).
constexpr float kBlurError = 0.2F;
constexpr float kNoiseOfCode = 3;  ///< var(D -+ S3) is 4 sigma^2 for b = +1, 2 sigma^2 for b = -1
constexpr float kFaintVariance = 0.25F;
constexpr std::int32_t kEndTrim_px = 3;

struct Sums {
  float dot = 0, energy = 0, noise = 0, blur = 0;
};

}  // namespace

void PolarityEvidence::measure_code(const PhaseMaps& phase, const NoiseModel& noise, const std::vector<Piece>& pieces,
                                    std::size_t k, Said& said) {
  Sums s;
  const std::size_t at = static_cast<std::size_t>(pieces[k].row) * static_cast<std::size_t>(phase.phase_rad.width());
  const PieceCore core = core_of(pieces, k, kEndTrim_px);
  for (std::int32_t u = core.begin; u < core.end; ++u) {
    const std::size_t i = at + static_cast<std::size_t>(u);
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
  said.code = s.dot / s.energy;
  said.variance = kNoiseOfCode * s.noise / (s.energy * s.energy) + blur * blur;
}

/// Cost of T under each sign: Gaussian about the sign, or with small probability anything in a width of 3. A sharp T
/// can contradict more strongly than a blurred one; one that says nothing costs nothing.
void PolarityEvidence::price(float outlier_cost, Said& said) {
  constexpr double kWidthOverRootTwoPi = 1.1968;
  const double cap =
      static_cast<double>(outlier_cost) + std::log(kWidthOverRootTwoPi / std::sqrt(static_cast<double>(said.variance)));
  const auto most = static_cast<float>(std::max(cap, 0.0));
  const float dp = said.code - 1, dm = said.code + 1, scale = 0.5F / said.variance;
  said.plus = std::min(scale * dp * dp, most);
  said.minus = std::min(scale * dm * dm, most);
}

void PolarityEvidence::measure(const PhaseMaps& phase, const NoiseModel& noise, const std::vector<Piece>& pieces,
                               const CellSigns& signs, float outlier_cost) {
  signs_ = &signs;
  said_.assign(pieces.size(), {});
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    measure_code(phase, noise, pieces, k, said_[k]);
    if (signs.informative) price(outlier_cost, said_[k]);
  }
}

void PolarityEvidence::costs(std::size_t piece, std::int32_t first_cell, std::span<float> out) const {
  const Said& said = said_[piece];
  for (std::size_t k = 0; k < out.size(); ++k)
    out[k] = signs_->at(first_cell + 2 * static_cast<std::int32_t>(k)) > 0 ? said.plus : said.minus;
}

Stance PolarityEvidence::stance(std::size_t piece, std::int32_t cell) const {
  const Said& said = said_[piece];
  if (said.variance > kFaintVariance) return Stance::kSilent;
  return said.code * signs_->at(cell) > 0 ? Stance::kAgrees : Stance::kContradicts;
}

}  // namespace enamel::algo
