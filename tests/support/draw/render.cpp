#include "tests/support/draw/render.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/support/draw/exposure.hpp"

namespace enamel::test {
namespace {

constexpr double kJump_mm = 0.15, kClipped_dn = 250;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

void mark_edges(DrawnTruth& truth) {
  const int w = truth.depth_mm.width(), h = truth.depth_mm.height();
  const auto jumps = [&](int u, int v, int du, int dv) {
    const float a = truth.depth_mm(u, v), b = truth.depth_mm(std::min(u + du, w - 1), std::min(v + dv, h - 1));
    if (std::isnan(a) || std::isnan(b)) return std::isnan(a) != std::isnan(b);
    return static_cast<double>(std::abs(a - b)) > kJump_mm;
  };
  for (int v = 0; v < h; ++v) {
    for (int u = 0; u < w; ++u) {
      if (!jumps(u, v, 1, 0) && !jumps(u, v, 0, 1)) continue;
      for (int y = std::max(0, v - kEdgeBand_px); y <= std::min(h - 1, v + kEdgeBand_px); ++y) {
        for (int x = std::max(0, u - kEdgeBand_px); x <= std::min(w - 1, u + kEdgeBand_px); ++x)
          truth.near_edge(x, y) = 1;
      }
    }
  }
}

DrawnTruth truth_at(const Stage& stage, double time_s) {
  const int w = stage.drawn.rig.camera.width, h = stage.drawn.rig.camera.height;
  DrawnTruth out;
  out.depth_mm = Map<float>(w, h, std::numeric_limits<float>::quiet_NaN());
  out.column_px = Map<double>(w, h, kNone);
  out.lit = out.near_edge = Map<std::uint8_t>(w, h);
  out.sigma_phi_rad = Map<float>(w, h, std::numeric_limits<float>::infinity());
  const Tracer tracer(stage.drawn, *stage.shape, time_s);
  for (std::size_t i = 0; i < stage.rays.size(); ++i) {
    const TracedPoint p = tracer.trace(stage.rays[i]);
    if (!(p.depth_mm > 0)) continue;
    out.depth_mm[i] = static_cast<float>(p.depth_mm);
    out.column_px[i] = p.column_px;
    out.lit[i] = p.lit ? 1 : 0;
  }
  mark_edges(out);
  return out;
}

/// Of the phase of frames 0, 1, 2 of four steps, or of mode M's three, by shot noise, read noise and rounding.
float sigma_phi(const calib::Rig& rig, const std::array<double, 4>& dn) {
  const calib::NoiseValues& n = *rig.noise;
  const bool micro = rig.patterns.mode == calib::PatternMode::kMicro;
  if (std::max({dn[0], dn[2], micro ? dn[3] : dn[1]}) > kClipped_dn) return std::numeric_limits<float>::infinity();
  double mean = 0.5 * (dn[0] + dn[2]), sine = mean - dn[1], cosine = 0.5 * (dn[0] - dn[2]);
  if (micro) {
    mean = (dn[0] + dn[2] + dn[3]) / 3;
    sine = (dn[3] - dn[2]) / std::numbers::sqrt3, cosine = (2 * dn[0] - dn[2] - dn[3]) / 3;
  }
  const double read_dn = n.read_noise_e / n.gain_e_per_dn;
  const double noise_dn = std::sqrt((mean - n.black_dn) / n.gain_e_per_dn + read_dn * read_dn + 1.0 / 12);
  return static_cast<float>(std::sqrt(micro ? 2.0 / 3 : 0.5) * noise_dn / std::max(1e-9, std::hypot(sine, cosine)));
}

void predict_noise(const Drawn& drawn, const std::array<FrameLight, 4>& light, DrawnTruth& truth) {
  const calib::NoiseValues& n = *drawn.rig.noise;
  for (std::size_t i = 0; i < truth.sigma_phi_rad.size(); ++i) {
    std::array<double, 4> dn{};
    for (std::size_t k = 0; k < 4; ++k)
      dn[k] = n.black_dn + static_cast<double>(light[k].signal[i]) * n.full_well_e / n.gain_e_per_dn;
    truth.sigma_phi_rad[i] = sigma_phi(drawn.rig, dn);
  }
}

double fastest(const Drawn& drawn, const std::array<FrameLight, 4>& light, const DrawnTruth& truth) {
  std::vector<double> changes;
  for (std::size_t i = 0; i < truth.lit.size(); ++i) {
    if (truth.lit[i] == 0 || truth.near_edge[i] != 0) continue;
    double most = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double change = std::abs(light[k + 1].column_px[i] - light[k].column_px[i]);
      most = std::isnan(change) ? most : std::max(most, change);
    }
    changes.push_back(most * 2 * std::numbers::pi / drawn.rig.patterns.period_px);
  }
  if (changes.empty()) return 0;
  const auto at = changes.begin() + static_cast<std::ptrdiff_t>(changes.size() * 95 / 100);
  std::nth_element(changes.begin(), at, changes.end());
  return *at;
}

}  // namespace

DrawnBurst render(const Drawn& drawn, const Shot& shot) {
  const Stage stage(drawn);
  DrawnBurst out;
  out.frames.width = drawn.rig.camera.width, out.frames.height = drawn.rig.camera.height;
  const std::array<FrameLight, 4> light = expose(stage, shot.later_s, shot.taken);
  for (std::size_t k = 0; k < 4; ++k)
    if (shot.taken[k]) out.frames.frames[k] = read_out(drawn, light[k].signal, shot.gain[k], 4 * shot.noise + k);
  if (!shot.with_truth) return out;
  out.truth = truth_at(stage, shot.later_s);
  const bool all = shot.taken == std::array{true, true, true, true};
  if (all) predict_noise(drawn, light, out.truth);
  if (all) out.truth.fastest_rad_a_frame = fastest(drawn, light, out.truth);
  return out;
}

}  // namespace enamel::test
