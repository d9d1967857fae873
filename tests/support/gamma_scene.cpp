#include "tests/support/gamma_scene.hpp"

#include <cmath>
#include <cstring>
#include <numbers>
#include <span>

#include "pipeline/decode/mode_t/closure.hpp"
#include "pipeline/decode/phase/phase_ripple.hpp"
#include "tests/support/fold_error.hpp"
#include "tests/support/half_fringes.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFull_dn = 60000;  // of 65535: rounding far below any ripple of interest

class Source {
 public:
  Source(const GammaScene& scene, std::uint64_t seed)
      : scene_(scene), normal_(seed), sigma_dn_(scene.noise * fundamental(scene.gamma) * kFull_dn) {}

  double operator()(double phase_rad) {
    const double wave = kFull_dn * std::pow(0.5 + 0.5 * std::cos(phase_rad), scene_.gamma);
    return 2000 + wave + (sigma_dn_ > 0 ? sigma_dn_ * normal_() : 0);
  }

 private:
  /// Amplitude of cos phi in (1/2 + 1/2 cos phi)^g, by the mean over 4096 points.
  static double fundamental(double gamma) {
    double sum = 0;
    for (int k = 0; k < 4096; ++k) {
      const double phi = 2 * kPi * k / 4096;
      sum += std::pow(0.5 + 0.5 * std::cos(phi), gamma) * std::cos(phi);
    }
    return 2 * sum / 4096;
  }

  GammaScene scene_;
  Normals normal_;
  double sigma_dn_;
};

struct Burst {
  std::vector<double> truth;
  std::vector<float> three, twice, four;
};

double true_phase(const GammaScene& s, int burst, int u, int v) {
  const double x = u - 0.5 * s.width, y = v - 0.5 * s.height;
  return 2 * kPi * (u + 0.21 * v) / s.period_px + 1e-5 * (x * x + 2 * y * y) + 0.7 * burst;
}

double three_step(double a, double b, double c) { return std::atan2(std::sqrt(3.0) * (a - c), 2 * b - a - c); }

pipeline::PhaseMaps four_step(const GammaScene& s, const std::array<std::vector<std::uint8_t>, 4>& frames,
                              std::vector<pipeline::CellSpan>& spans) {
  pipeline::BurstView view{s.width, s.height, 16, {}};
  for (std::size_t k = 0; k < 4; ++k) view.frames[k] = frames[k];
  pipeline::NoiseModel noise;
  noise.floor_dn2 = 100, noise.full_scale_dn = 65535;
  pipeline::PhaseMaps maps;
  pipeline::compute_phase(view, noise, {}, maps);
  // Cells are cut at the signs of the three-frame phase; every cell inside the image covers its half fringe.
  for (int v = 0; v < s.height; ++v) {
    cut_half_fringes(
        v, s.width, [&](int u) { return maps.phase_rad(u, v) < 0 ? 1 : 0; }, spans);
  }
  pipeline::PolarityMaps polarity;
  pipeline::apply_polarity(spans, {std::vector<float>(8, 1.0F), false}, noise, {}, maps, polarity);
  return maps;
}

struct Rendered {
  Burst burst;
  pipeline::PhaseMaps maps;
  std::vector<pipeline::CellSpan> spans;
};

Rendered render_burst(const GammaScene& s, int number) {
  Source source(s, s.seed + static_cast<std::uint64_t>(number));
  Rendered out;
  std::array<std::vector<std::uint8_t>, 4> frames;
  for (int v = 0; v < s.height; ++v) {
    for (int u = 0; u < s.width; ++u) {
      const double phi = true_phase(s, number, u, v);
      out.burst.truth.push_back(phi);
      std::array<double, 2> estimates{};
      for (std::size_t half = 0; half < 2; ++half) {
        const double shift = static_cast<double>(half) * kPi / 3, third = 2 * kPi / 3;
        const double a = source(phi + shift - third), b = source(phi + shift), c = source(phi + shift + third);
        estimates[half] = three_step(a, b, c) - shift;
      }
      out.burst.three.push_back(static_cast<float>(estimates[0]));
      out.burst.twice.push_back(static_cast<float>(estimates[0] + 0.5 * wrap_pi(estimates[1] - estimates[0])));
      for (std::size_t k = 0; k < 4; ++k) {
        const double dn = std::clamp(std::round(source(phi + static_cast<double>(k) * kPi / 2)), 0.0, 65535.0);
        const auto value = static_cast<std::uint16_t>(dn);
        std::array<std::uint8_t, 2> bytes{};
        std::memcpy(bytes.data(), &value, 2);
        frames[k].insert(frames[k].end(), bytes.begin(), bytes.end());
      }
    }
  }
  out.maps = four_step(s, frames, out.spans);
  const auto phases = out.maps.phase_rad.pixels();
  out.burst.four.assign(phases.begin(), phases.end());
  return out;
}

double repeating(const std::vector<Rendered>& bursts, std::vector<float> Burst::*estimate) {
  ErrorFolder folder;
  for (const Rendered& r : bursts) {
    for (std::size_t i = 0; i < r.burst.truth.size(); ++i)
      folder.add(wrap_pi(static_cast<double>((r.burst.*estimate)[i]) - r.burst.truth[i]), r.burst.truth[i]);
  }
  return folder.result().repeating_rad;
}

}  // namespace

GammaRipple measure_gamma(const GammaScene& scene, int bursts) {
  std::vector<Rendered> all;
  pipeline::PhaseMoments moments;
  for (int k = 0; k < bursts; ++k) {
    all.push_back(render_burst(scene, k));
    const Rendered& r = all.back();
    moments.add(pipeline::phase_moments(r.spans, r.maps));
  }
  GammaRipple out;
  out.three_step = repeating(all, &Burst::three);
  out.double_three_step = repeating(all, &Burst::twice);
  out.four_step = repeating(all, &Burst::four);
  const std::vector<Rendered> raw = all;
  pipeline::PhaseRipple one;
  one.sine[0] = pipeline::level(moments, 1).sine[0];
  for (Rendered& r : all) pipeline::correct_phase(one, r.burst.four);
  out.one_term = repeating(all, &Burst::four);
  all = raw;
  const pipeline::PhaseRipple ripple = pipeline::level(moments);
  for (Rendered& r : all) pipeline::correct_phase(ripple, r.burst.four);
  out.levelled = repeating(all, &Burst::four);
  return out;
}

}  // namespace enamel::test
