#include "calib/solve/measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/solve/board_view.hpp"
#include "calib/solve/ground.hpp"
#include "calib/solve/median.hpp"
#include "calib/target/coded_grid.hpp"

namespace enamel::calib {
namespace {

constexpr double kMaxBlur_px = 1.5;       // sigma of an edge (docs/calibration.md §3)
constexpr double kSaturatedLevel = 0.98;  // of full scale
constexpr double kMaxSaturated = 0.02;    // of the discs' pixels
constexpr double kMinUsable = 0.7;        // of the dots of the design
constexpr double kMarginSigmas = 4;       // of the edge's blur: no light from beyond the contour inside
constexpr double kMarginExtra_px = 1.0;   // half the pixel's diagonal, and some
constexpr double kReach_px = 12;          // of the ground around a disc: less leaves its light's gradient uncertain
constexpr double kMaxResidual = 0.08;     // of the step between disc and ground: what is seen is no whole disc

/// Mean of all lit frames above the sensor's black, and its noise. The four steps of a fringe add up to an even light,
/// so that the photons of every frame count for the contours: ten to twenty times those of the white frame alone.
struct LitImage {
  Map<float> image;
  PixelNoise noise;
};

LitImage lit_image(const PoseFrames& f, const PixelNoise& noise) {
  std::vector<const Map<float>*> frames{&f.white};
  for (const auto* levels : {&f.along_u, &f.along_v}) {
    for (const FringeLevel& level : *levels)
      for (const auto& frame : level.frames) frames.push_back(&frame);
  }
  const int n = static_cast<int>(frames.size());
  // One number: the black frame pixel by pixel would bring more noise than all lit frames have, and what light it shows
  // has the same contours.
  const double black = median({f.black.pixels().begin(), f.black.pixels().end()});
  LitImage lit{Map<float>(f.white.width(), f.white.height()), noise.of_mean(n)};
  for (std::size_t i = 0; i < lit.image.size(); ++i) {
    double sum = 0;
    for (const auto* frame : frames) sum += static_cast<double>((*frame)[i]);
    lit.image[i] = static_cast<float>(sum / n - black);
  }
  return lit;
}

/// Share of the white frame's pixels inside the dots that are at full scale.
double saturated_share(const Map<float>& white, const DotGrid& grid, double saturation_dn) {
  std::size_t all = 0, full = 0;
  for (const GridDot& dot : grid.dots) {
    const int r = static_cast<int>(dot.blob.half_axes().y() * 0.6);
    const int cu = static_cast<int>(dot.blob.centre.x()), cv = static_cast<int>(dot.blob.centre.y());
    for (int v = cv - r; v <= cv + r; ++v) {
      for (int u = cu - r; u <= cu + r; ++u) {
        if (!white.contains(u, v)) continue;
        ++all;
        full += static_cast<double>(white(u, v)) >= kSaturatedLevel * saturation_dn ? 1U : 0U;
      }
    }
  }
  return all == 0 ? 0 : static_cast<double>(full) / static_cast<double>(all);
}

std::optional<DiscFit> fit_dot(const LitImage& lit, const DotGrid& grid, const GridDot& dot, EdgeModel edges) {
  const double reach_px = std::min(kReach_px, 0.5 * (grid.spacing_px - 2 * dot.blob.half_axes().x()));
  const auto start = disc_moments(lit.image, dot.blob, reach_px);
  if (!start) return {};
  return fit_disc(lit.image, lit.noise, *start, reach_px, edges);
}

/// Radius of a coded board's hole over that of its ring; 0 for a dot.
double inner_share(const TargetDesign& target, int dot) {
  const bool is_ring = !target.rings.empty() && target.rings[static_cast<std::size_t>(dot)] != 0;
  return is_ring ? target.ring_inner_mm / target.radius_mm : 0;
}

/// Finds the dots and paints over the holes of those that are rings: the contours that are fitted are the outer ones.
Result<DotGrid> find_dots(LitImage& lit, const TargetDesign& target) {
  ENAMEL_TRY_ASSIGN(DotGrid grid, find_dot_grid(lit.image, target));
  for (const GridDot& dot : grid.dots)
    if (const double share = inner_share(target, dot.index); share > 0) fill_ring(lit.image, dot.blob, share);
  return grid;
}

/// Projector coordinates on a dot; a ring's hole, its edge and the blur around it are left out.
std::vector<ProjectorSample> samples_on(const CoordinateMap& u, const CoordinateMap& v, const DiscFit& fit,
                                        double share) {
  const double margin_px = kMarginSigmas * fit.blur_px + kMarginExtra_px;
  auto samples = disc_samples(u, v, fit.ellipse, margin_px);
  if (share > 0) {
    const double clear = share + margin_px / fit.ellipse.half_axes().y();
    std::erase_if(samples, [&](const ProjectorSample& s) { return fit.ellipse.radius_at(s.camera_px) < clear; });
  }
  return samples;
}

struct Fringes {
  CoordinateMap u, v;
};

Result<std::optional<Fringes>> decode_fringes(const PoseFrames& frames, const PixelNoise& noise,
                                              std::array<int, 2> projector_size_px) {
  if (frames.along_u.empty() || frames.along_v.empty()) return std::optional<Fringes>{};
  ENAMEL_TRY_ASSIGN(auto u, decode_coordinate(frames.along_u, projector_size_px[0], noise));
  ENAMEL_TRY_ASSIGN(auto v, decode_coordinate(frames.along_v, projector_size_px[1], noise));
  return std::optional<Fringes>(Fringes{std::move(u), std::move(v)});
}

Result<void> check_lit(const PoseFrames& frames, const DotGrid& grid, const TargetDesign& target,
                       double saturation_dn) {
  const Map<float>& as_taken = frames.raw_white.size() > 0 ? frames.raw_white : frames.white;
  const double saturated = saturated_share(as_taken, grid, saturation_dn);
  if (!target.is_white_on_dark || saturated <= kMaxSaturated) return {};
  return fail(
      ErrorCode::kCalibrationPoses,
      fmt::format("saturated: {:.0f} % of the dots' pixels are at full scale; lower the exposure", 100 * saturated));
}

Result<void> check_sharp(const PoseView& pose, std::size_t fitted, int expected) {
  if (pose.blur_px > kMaxBlur_px) {
    return fail(
        ErrorCode::kCalibrationPoses,
        fmt::format("blurred: edges of {:.2f} px sigma, limit {:.1f}; hold still and stay inside the depth range",
                    pose.blur_px, kMaxBlur_px));
  }
  if (static_cast<double>(fitted) < kMinUsable * expected) {
    return fail(ErrorCode::kCalibrationPoses,
                fmt::format("{} of {} dots can be measured in both images; show the whole target to camera and "
                            "projector",
                            fitted, expected));
  }
  return {};
}

Result<PoseView> measure_board(const PoseFrames& frames, const TargetDesign& target, const CoordinateMap& u,
                               const CoordinateMap& v) {
  ENAMEL_TRY_ASSIGN(const auto corners, find_chessboard(frames.white, target));
  PoseView pose = board_view(frames.name, corners, target, u, v);
  ENAMEL_TRY(check_sharp(pose, pose.dots.size(), target.size()));
  return pose;
}

}  // namespace

Result<PoseView> measure_pose(const PoseFrames& frames, const TargetDesign& target, const PixelNoise& image_noise,
                              double saturation_dn, std::array<int, 2> projector_size_px, EdgeModel edges) {
  ENAMEL_TRY_ASSIGN(const auto fringes, decode_fringes(frames, image_noise, projector_size_px));
  const bool is_coded = target.type == TargetType::kCodedDots;
  if (!fringes && !is_coded)
    return fail(ErrorCode::kCalibrationFolder, frames.name + ": fringes along both axes are needed");
  if (target.type == TargetType::kChessboard) return measure_board(frames, target, fringes->u, fringes->v);
  LitImage lit = lit_image(frames, image_noise);
  ENAMEL_TRY_ASSIGN(const DotGrid grid, find_dots(lit, target));
  ENAMEL_TRY(check_lit(frames, grid, target, saturation_dn));
  PoseView pose{.name = frames.name, .dots = {}, .ground = {}, .blur_px = 0};
  std::vector<double> blurs;
  for (const GridDot& dot : grid.dots) {
    const auto fit = fit_dot(lit, grid, dot, edges);
    if (!fit || fit->residual_share > kMaxResidual) continue;
    blurs.push_back(fit->blur_px);
    DotView view{
        .dot = dot.index, .ellipse = fit->ellipse, .covariance_px2 = fit->covariance, .samples = {}, .map = {}};
    view.camera_px = fit->ellipse.centre;
    if (fringes) view.samples = samples_on(fringes->u, fringes->v, *fit, inner_share(target, dot.index));
    const auto map = fit_local_map(view.samples, view.camera_px);
    if (!map && !is_coded) continue;
    map ? static_cast<void>(view.map = *map) : view.samples.clear();
    pose.dots.push_back(std::move(view));
  }
  pose.blur_px = median(blurs);
  // A coded board may leave the field: what counts is what is in view.
  ENAMEL_TRY(check_sharp(pose, pose.dots.size(), is_coded ? static_cast<int>(grid.dots.size()) : target.size()));
  if (is_coded) return pose;
  const double period_px = static_cast<double>(projector_size_px[0]) / frames.along_u.back().cycles;
  pose.ground = ground_samples(fringes->u, pose, target, period_px);
  return pose;
}

Result<EdgeModel> choose_edge_model(const PoseFrames& frames, const TargetDesign& target,
                                    const PixelNoise& image_noise) {
  LitImage lit = lit_image(frames, image_noise);
  ENAMEL_TRY_ASSIGN(const DotGrid grid, find_dots(lit, target));
  double lens = 0, taps = 0;
  for (const GridDot& dot : grid.dots) {
    const auto by_lens = fit_dot(lit, grid, dot, EdgeModel::kLensThenPixel);
    const auto by_taps = fit_dot(lit, grid, dot, EdgeModel::kPixelThenTaps);
    if (!by_lens || !by_taps) continue;
    lens += by_lens->misfit;
    taps += by_taps->misfit;
  }
  return taps < lens ? EdgeModel::kPixelThenTaps : EdgeModel::kLensThenPixel;
}

PixelNoise estimate_noise(const PoseFrames& frames) {
  constexpr int kBins = 16;
  // Second difference along the row: free of any slope, variance 6 sigma². The median of its size is deaf to edges.
  std::array<std::vector<double>, kBins> size, level;
  const Map<float>& white = frames.white;
  double brightest = 1;
  for (const float p : white.pixels()) brightest = std::max(brightest, static_cast<double>(p));
  for (int v = 0; v < white.height(); ++v) {
    for (int u = 1; u + 1 < white.width(); ++u) {
      const double centre = static_cast<double>(white(u, v));
      const double signal = centre - static_cast<double>(frames.black(u, v));
      const double d = static_cast<double>(white(u - 1, v)) - 2 * centre + static_cast<double>(white(u + 1, v));
      const auto bin = static_cast<std::size_t>(std::clamp(signal / brightest * kBins, 0.0, kBins - 1.0));
      size[bin].push_back(std::abs(d));
      level[bin].push_back(signal);
    }
  }
  // Weighted line through (signal, variance); 0.6745 = median of |N(0,1)|.
  double s0 = 0, s1 = 0, s2 = 0, t0 = 0, t1 = 0;
  for (std::size_t b = 0; b < kBins; ++b) {
    if (size[b].size() < 200) continue;
    const double sigma = median(size[b]) / 0.6745;
    const double variance = std::max(sigma * sigma / 6, 1.0 / 12), x = median(level[b]);
    const double w = static_cast<double>(size[b].size()) / (variance * variance);
    s0 += w;
    s1 += w * x;
    s2 += w * x * x;
    t0 += w * variance;
    t1 += w * x * variance;
  }
  const double det = s0 * s2 - s1 * s1;
  if (!(det > 1e-9 * s0 * s2)) return {s0 > 0 ? t0 / s0 : 1.0, 0.0};
  const double slope = std::max(0.0, (s0 * t1 - s1 * t0) / det);
  return {std::max(1.0 / 12, (t0 - slope * s1) / s0), slope};
}

}  // namespace enamel::calib
