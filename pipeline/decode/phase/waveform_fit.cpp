#include "pipeline/decode/phase/waveform_fit.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <cstddef>

namespace enamel::pipeline {
namespace {

constexpr std::size_t kPoints = 128;  // layout: of the fringe, for the moments of a wave
constexpr int kPasses = 6;            // layout: Gauss-Newton from h = 0; the third changes nothing in the fourth digit
constexpr float kMostNoise_rad = 0.4F;  // derived: noise of sigma leaves exp(-9 sigma^2/2) of <cos 3 phi>: half
constexpr double kDifference = 1e-4;    // layout: of a harmonic, for slopes

using Harmonics = Eigen::Vector4d;
using Values = Eigen::VectorXd;

/// f(phi) of all folds from the direction of (C, S).
void fold_values(std::complex<double> direction, const std::vector<FrameScheme::Fold>& folds, double* out) {
  std::complex<double> power = direction;
  int times = 1;
  for (std::size_t k = 0; k < folds.size(); ++k) {
    for (; times < folds[k].times; ++times) power *= direction;
    out[k] = folds[k].sine ? power.imag() : power.real();
  }
}

/// crowding, modulation, mean, one after the other.
Values moments_of(const Waveform& wave, const FrameScheme& frames) {
  const SeenWave seen = see(wave, frames, kPoints);
  const auto folds = static_cast<Eigen::Index>(frames.folds.size());
  Values length(kPoints);
  double b = 0, a = 0;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double of_pixel = std::sqrt(seen.cosine[i] * seen.cosine[i] + seen.sine[i] * seen.sine[i]);
    length(static_cast<Eigen::Index>(i)) = of_pixel;
    b += of_pixel / kPoints, a += seen.mean[i] / kPoints;
  }
  Values out = Values::Zero(3 * folds);
  std::vector<double> f(frames.folds.size());
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double of_pixel = length(static_cast<Eigen::Index>(i));
    fold_values({seen.cosine[i] / of_pixel, seen.sine[i] / of_pixel}, frames.folds, f.data());
    const Eigen::Map<const Values> values(f.data(), folds);
    out.segment(0, folds) += values / kPoints;
    out.segment(folds, folds) += (of_pixel / b - 1) / kPoints * values;
    out.segment(2 * folds, folds) += (seen.mean[i] - a) / b / kPoints * values;
  }
  return out;
}

Waveform wave_of(const Harmonics& h) { return {{h(0), h(1), h(2), h(3)}}; }

/// Sums over [first, first + width) of a row, slid along it.
struct LocalMean {
  std::vector<double> modulation, mean;
  std::vector<std::int32_t> valid;

  explicit LocalMean(std::size_t width) : modulation(width + 1), mean(width + 1), valid(width + 1) {}

  /// Noisy pixels count as well: a wave that is dark for half a fringe would be told by its bright half.
  void sum_row(const PhaseMaps& maps, std::size_t at) {
    for (std::size_t u = 0; u + 1 < valid.size(); ++u) {
      const PixelReject reject = maps.reject[at + u];
      const bool lit = reject == PixelReject::kNone || reject == PixelReject::kNoisy;
      const bool counts = lit && maps.sigma_rad[at + u] < kMostNoise_rad;
      modulation[u + 1] = modulation[u] + (counts ? static_cast<double>(maps.modulation_dn[at + u]) : 0);
      mean[u + 1] = mean[u] + (counts ? static_cast<double>(maps.mean_dn[at + u]) : 0);
      valid[u + 1] = valid[u] + (counts ? 1 : 0);
    }
  }
};

/// By the likeliest of the priors; and by the spread of projectors alone.
FoundWave likeliest(const WaveMoments& moments, const FrameScheme& frames, const WaveFitConfig& config,
                    std::span<const WavePrior> priors) {
  WaveFit best = fit_waveform(moments, frames, priors.front(), config);
  for (const WavePrior& prior : priors.subspan(1)) {
    const WaveFit fit = fit_waveform(moments, frames, prior, config);
    if (fit.cost < best.cost) best = fit;
  }
  const WavePrior any{{}, config.prior, config.least_strength};
  const bool is_any = priors.size() == 1 && priors.front() == any;
  return {best.wave, is_any ? best.wave : fit_waveform(moments, frames, any, config).wave};
}

}  // namespace

WaveMoments wave_moments(const PhaseMaps& maps, const FrameScheme& frames, int fringe_px, int row_step) {
  const std::size_t folds = frames.folds.size();
  WaveMoments out{0, std::vector<double>(folds), std::vector<double>(folds), std::vector<double>(folds)};
  const auto width = static_cast<std::size_t>(maps.phase_rad.width()), wide = static_cast<std::size_t>(fringe_px);
  LocalMean local(width);
  std::vector<double> f(folds);
  for (int v = row_step / 2; v < maps.phase_rad.height() && wide > 0 && wide < width; v += row_step) {
    const std::size_t at = static_cast<std::size_t>(v) * width;
    local.sum_row(maps, at);
    for (std::size_t from = 0; from + wide <= width; ++from) {
      const std::size_t to = from + wide, i = at + from + wide / 2;
      if (local.valid[to] - local.valid[from] != fringe_px) continue;
      const double b = (local.modulation[to] - local.modulation[from]) / fringe_px;
      const double a = (local.mean[to] - local.mean[from]) / fringe_px;
      const auto of_pixel = static_cast<double>(maps.modulation_dn[i]);
      fold_values({static_cast<double>(maps.cosine_dn[i]) / of_pixel, static_cast<double>(maps.sine_dn[i]) / of_pixel},
                  frames.folds, f.data());
      const double swell = of_pixel / b - 1, lift = (static_cast<double>(maps.mean_dn[i]) - a) / b;
      for (std::size_t k = 0; k < folds; ++k)
        out.crowding[k] += f[k], out.modulation[k] += swell * f[k], out.mean[k] += lift * f[k];
      ++out.pixels;
    }
  }
  for (auto* sums : {&out.crowding, &out.modulation, &out.mean})
    for (double& sum : *sums) sum /= std::max(1.0, out.pixels);
  return out;
}

WaveFit fit_waveform(const WaveMoments& moments, const FrameScheme& frames, const WavePrior& prior,
                     const WaveFitConfig& config) {
  const auto folds = static_cast<Eigen::Index>(frames.folds.size());
  Values seen(3 * folds), weight(3 * folds);
  const double counting = 1 / std::sqrt(2 * moments.pixels);
  for (Eigen::Index k = 0; k < folds; ++k) {
    const auto at = static_cast<std::size_t>(k);
    seen(k) = moments.crowding[at], seen(folds + k) = moments.modulation[at], seen(2 * folds + k) = moments.mean[at];
    weight(k) = 1 / (config.crowding_spread * config.crowding_spread + counting * counting);
    weight(folds + k) = weight(2 * folds + k) = 1 / (config.ripple_spread * config.ripple_spread);
  }
  Harmonics h, stiffness;
  for (Eigen::Index n = 0; n < h.size(); ++n) {
    h(n) = prior.mean.harmonic[static_cast<std::size_t>(n)];
    stiffness(n) = std::pow(prior.sigma[static_cast<std::size_t>(n)], -2);
  }
  const Harmonics expected = h;
  for (int pass = 0; pass < kPasses; ++pass) {
    const Values now = moments_of(wave_of(h), frames);
    Eigen::MatrixXd slope(3 * folds, h.size());
    for (Eigen::Index n = 0; n < h.size(); ++n)
      slope.col(n) = (moments_of(wave_of(h + kDifference * Harmonics::Unit(n)), frames) - now) / kDifference;
    const Eigen::Matrix4d normal =
        slope.transpose() * weight.asDiagonal() * slope + Eigen::Matrix4d(stiffness.asDiagonal());
    const Harmonics step = normal.inverse() * (slope.transpose() * weight.asDiagonal() * (seen - now) -
                                               stiffness.cwiseProduct(h - expected));
    h += step;
    if (step.norm() < kDifference) break;
  }
  const Values off = seen - moments_of(wave_of(h), frames);
  const Harmonics away = h - expected;
  const double cost = weight.dot(off.cwiseAbs2()) + stiffness.dot(away.cwiseAbs2()) - stiffness.array().log().sum();
  return {wave_of(h), cost};
}

FoundWave find_waveform(const PhaseMaps& maps, const FrameScheme& frames, int fringe_px, const WaveFitConfig& config,
                        std::span<const WavePrior> priors) {
  if (priors.empty()) return {};
  const double least = priors.front().least_strength;
  const auto clear = [](const Waveform& wave, double limit) { return wave.strength() < limit ? Waveform{} : wave; };
  const int glance_step = static_cast<int>(static_cast<double>(maps.phase_rad.size()) / config.glance_pixels);
  if (glance_step > config.row_step) {
    const WaveMoments moments = wave_moments(maps, frames, fringe_px, glance_step);
    if (moments.pixels >= config.min_pixels) {
      const FoundWave glanced = likeliest(moments, frames, config, priors);
      if (clear(glanced.wave, 0.5 * least).is_cosine()) return {{}, glanced.shown};
    }
  }
  const WaveMoments moments = wave_moments(maps, frames, fringe_px, config.row_step);
  if (moments.pixels < config.min_pixels)
    return {priors.size() == 1 ? clear(priors.front().mean, least) : Waveform{}, std::nullopt};
  const FoundWave found = likeliest(moments, frames, config, priors);
  return {clear(found.wave, least), found.shown};
}

}  // namespace enamel::pipeline
