#include "pipeline/decode/mode_t/torn.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "pipeline/decode/mode_t/chosen.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kBehind = 3;  ///< layout: pixels that a line goes through, whose weights are made for it

/// To a pixel's neighbours in a picture `width` wide.
using Steps = std::array<std::ptrdiff_t, 8>;
Steps steps_of(int width) {
  const auto w = static_cast<std::ptrdiff_t>(width);
  return {-w - 1, -w, -w + 1, -1, 1, w - 1, w, w + 1};
}

/// To within half a turn.
float wrapped(float rad) { return rad - kTwoPiF * std::floor(rad / kTwoPiF + 0.5F); }

}  // namespace

struct TornPixels::Line {
  float expected_rad, sigma_rad, mean_dn, modulation_dn;
};

struct TornPixels::Surface {
  const PhaseMaps& maps;
  const Map<std::int16_t>& wraps;
  const CellSigns& signs;
  const NoiseModel& noise;

  /// A bit for each step whose next pixel and those behind it hold. Without branches: nobody could predict them.
  [[nodiscard]] unsigned lines_to(std::size_t index, const Steps& steps) const {
    static_assert(static_cast<unsigned>(PixelReject::kNone) == 0);
    const PixelReject* reject = maps.reject.pixels().data() + index;
    unsigned lines = 0;
    for (std::size_t k = 0; k < steps.size(); ++k) {
      unsigned left_out = 0;
      for (int n = 1; n <= kBehind; ++n) left_out |= static_cast<unsigned>(reject[n * steps[k]]);
      lines |= (left_out == 0 ? 1U : 0U) << k;
    }
    return lines;
  }

  /// Through the pixel `step` from `index` and those behind it.
  [[nodiscard]] Line behind(std::size_t index, std::ptrdiff_t step) const {
    const auto at = [&](int k) { return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(index) + k * step); };
    const auto phi = [&](int k) { return maps.phase_rad[at(k)] + kTwoPiF * static_cast<float>(wraps[at(k)]); };
    const float near = phi(1), slope = 0.5F * (near - phi(kBehind));
    // 1.5 times the first less half of the third: 2.5 times the variance of one.
    return {near + slope, maps.sigma_rad[at(1)] * root(2.5F), maps.mean_dn[at(1)], maps.modulation_dn[at(1)]};
  }
};

void TornPixels::start(std::span<const CellSpan> spans, std::span<const SaturatedPixel> saturated,
                       const TornConfig& config, const PhaseConfig& gates, int width, int height) {
  config_ = config;
  max_sigma_rad_ = gates.max_sigma_rad;
  width_ = width, height_ = height;
  spans_ = spans, saturated_ = saturated;
  pixels_.clear();
  regained_.clear();
}

void TornPixels::take_row(int v, std::size_t at, const PixelRow& row, const ClosedRow& closed, PixelReject* reject) {
  if (spans_.empty() || spans_.front().row != v) return;
  const auto begin = static_cast<std::size_t>(spans_.front().begin);
  std::size_t end = begin;
  for (; !spans_.empty() && spans_.front().row == v; spans_ = spans_.subspan(1))
    end = static_cast<std::size_t>(spans_.front().end);
  const float limit = config_.sigmas * config_.sigmas;
  for (std::size_t u = begin; u < end; ++u) {
    const bool torn = (closed.squares[u] > limit) & (closed.noise[u] > 0);
    closed.noise[u] = select(torn, 0, closed.noise[u]);
    reject[u] = torn ? PixelReject::kEdge : reject[u];
  }
  // A line of kBehind pixels has room in every direction.
  if (v < kBehind || v + kBehind >= height_ || width_ <= 2 * kBehind) return;
  const auto margin = static_cast<std::size_t>(kBehind), last = static_cast<std::size_t>(width_) - margin;
  for (std::size_t u = std::max(begin, margin); u < std::min(end, last); ++u)
    if (reject[u] == PixelReject::kEdge && !was_saturated(at + u)) take(u, at + u, row);
}

bool TornPixels::was_saturated(std::size_t index) {
  while (!saturated_.empty() && saturated_.front().index < index) saturated_ = saturated_.subspan(1);
  return !saturated_.empty() && saturated_.front().index == index;
}

/// Frames as polarity.hpp left them: frame 3 in the residual, NaN without it, its sign in that of the weight, even of
/// weight 0.
void TornPixels::take(std::size_t u, std::size_t index, const PixelRow& row) {
  const RowErrors& e = row.errors;
  const float mean = row.mean[u] - e.black_dn, c = row.cosine[u], b = std::copysign(1.0F, e.weight[u]);
  const float residual = select(row.code[u] == row.code[u], row.code[u], 0);
  const float three = row.sine[u] + 0.5F * std::abs(e.weight[u]) * residual;
  pixels_.push_back(
      {index, {mean + c, mean - three, mean - c, mean + b * (three - row.code[u])}, e.change(u), e.harmonic[u], 0});
}

TornPixels::Way TornPixels::way_without(std::size_t missing, const Pixel& pixel, const NoiseModel& noise) {
  const FourStepPixel p = solve_without(missing, pixel.frames, pixel.change, pixel.harmonic);
  const float b = root(p.cosine * p.cosine + p.sine * p.sine);
  return {atan2_poly(p.sine, p.cosine), sigma_without(missing, p, pixel.frames, noise), p.mean + noise.black_dn, b,
          p.sine / (b + 1e-6F)};
}

/// Whether a way of this mean light could continue the line, before its equations are solved: most cannot.
bool TornPixels::could_be(float mean, const Line& line, const NoiseModel& noise) const {
  const float beside = line.mean_dn - noise.black_dn;
  return std::abs(mean - beside) < 2 * config_.same_light * beside + 2 * root(noise.variance(line.mean_dn));
}

/// By how many sigmas a way is off the line in phase; infinite where it does not continue it.
float TornPixels::sigmas_off(const Way& way, float off_rad, const Line& line, const NoiseModel& noise) const {
  const float same = config_.same_light, slack = 2 * root(noise.variance(line.mean_dn));  // noise of both
  const float own2 = way.sigma_rad * way.sigma_rad, mixed2 = config_.mixed_rad * config_.mixed_rad;
  const bool fits = own2 + mixed2 < max_sigma_rad_ * max_sigma_rad_ && std::abs(off_rad) < config_.most_turn_rad &&
                    std::abs(way.mean_dn - line.mean_dn) < same * (line.mean_dn - noise.black_dn) + slack &&
                    std::abs(way.modulation_dn - line.modulation_dn) < 1.5F * same * line.modulation_dn + slack;
  const float sigmas = std::abs(off_rad) / root(own2 + line.sigma_rad * line.sigma_rad);
  return fits && sigmas < config_.continues_sigmas ? sigmas : std::numeric_limits<float>::infinity();
}

/// The way that continues one of the lines towards the pixel best, of those not asked before.
std::optional<TornPixels::Found> TornPixels::find(Pixel& pixel, const Surface& surface) const {
  const NoiseModel& noise = surface.noise;
  const Frames& x = pixel.frames;
  std::optional<Way> first, last;
  std::optional<Found> best;
  float least = std::numeric_limits<float>::infinity();
  const auto offer = [&](const Way& way, const Line& line) {
    const float off = wrapped(way.phase_rad - line.expected_rad), sigmas = sigmas_off(way, off, line, noise);
    if (!(sigmas < least)) return;
    least = sigmas;
    best = Found{pixel.index, way, line.expected_rad + off};
  };
  const Steps steps = steps_of(width_);
  unsigned lines = surface.lines_to(pixel.index, steps) & ~pixel.asked;
  pixel.asked |= lines;
  for (; lines != 0; lines &= lines - 1) {
    const Line line = surface.behind(pixel.index, steps[static_cast<std::size_t>(std::countr_zero(lines))]);
    if (could_be(0.5F * (x[0] + x[2]), line, noise)) {
      if (!first) first = way_without(3, pixel, noise);
      offer(*first, line);
    }
    if (!could_be(0.5F * (x[1] + x[3]), line, noise)) continue;
    if (!(surface.signs.at(static_cast<int>(std::floor(line.expected_rad / kPiF))) > 0)) continue;
    if (!last) last = way_without(0, pixel, noise);
    if (std::abs(last->sine) > kClearOfFlip) offer(*last, line);
  }
  return best;
}

void TornPixels::put(PhaseMaps& maps, Map<std::int16_t>& wraps) {
  for (const Found& f : found_) {
    const float turns = std::floor(f.absolute_rad / kTwoPiF + 0.5F);
    maps.reject[f.index] = PixelReject::kNone;
    wraps[f.index] = static_cast<std::int16_t>(turns);
    maps.phase_rad[f.index] = f.absolute_rad - kTwoPiF * turns;
    maps.sigma_rad[f.index] = f.way.sigma_rad;
    maps.mean_dn[f.index] = f.way.mean_dn, maps.modulation_dn[f.index] = f.way.modulation_dn;
    regained_.push_back(f.index);
    for (const std::ptrdiff_t step : steps_of(width_))
      beside_[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(f.index) + step)] = 1;
  }
}

void TornPixels::regain(const CellSigns& signs, const NoiseModel& noise, PhaseMaps& maps, Map<std::int16_t>& wraps) {
  const Surface surface{maps, wraps, signs, noise};
  for (int reach = 0; reach < config_.reach_px; ++reach) {
    found_.clear();
    for (Pixel& pixel : pixels_) {
      const bool news = reach == 0 || beside_[pixel.index] != 0;
      if (!news || maps.reject[pixel.index] == PixelReject::kNone) continue;
      if (const auto found = find(pixel, surface)) found_.push_back(*found);
    }
    if (found_.empty()) break;
    beside_.assign(maps.reject.size(), 0);
    put(maps, wraps);
  }
  // Only now: the lines above are judged by noise.
  for (const std::size_t i : regained_)
    maps.sigma_rad[i] = root(maps.sigma_rad[i] * maps.sigma_rad[i] + config_.mixed_rad * config_.mixed_rad);
}

}  // namespace enamel::pipeline
