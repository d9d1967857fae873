#include "tests/support/plaster_eye.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>

#include "pipeline/decode/mode_t/closure.hpp"
#include "pipeline/decode/unwrap/cells.hpp"
#include "pipeline/decode/unwrap/flood.hpp"
#include "pipeline/decode/unwrap/links.hpp"
#include "tests/support/half_fringes.hpp"

namespace enamel::test {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr calib::DepthRange kDepth_mm{650, 1000};  // generous about the 750 … 846 that the set's author implies
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

pipeline::CellSigns all_plus() { return {std::vector<float>(128, 1.0F), false}; }

/// Spans of all pixels with amplitude, cut where the phase is 0 or pi, without unwrapping: enough for a solution that
/// needs no order.
std::vector<pipeline::CellSpan> lit_spans(const StepSolution& s) {
  std::vector<pipeline::CellSpan> spans;
  for (int v = 0; v < s.amplitude_dn.height(); ++v) {
    const auto half_at = [&](int u) -> std::optional<std::int32_t> {
      if (!(s.amplitude_dn(u, v) > kPlasterMinAmplitude_dn)) return std::nullopt;
      return s.phase_rad(u, v) < 0 ? 1 : 0;
    };
    cut_half_fringes(v, s.amplitude_dn.width(), half_at, spans);
  }
  return spans;
}

Map<float> corrected_reference(const StepSolution& s) {
  pipeline::PhaseMaps maps;
  maps.resize(s.phase_rad.width(), s.phase_rad.height());
  pipeline::PolarityMaps polarity;
  polarity.weight = Map<float>(s.phase_rad.width(), s.phase_rad.height(), 1.0F);
  for (std::size_t i = 0; i < s.phase_rad.size(); ++i) {
    maps.mean_dn[i] = s.mean_dn[i];
    maps.phase_rad[i] = s.phase_rad[i];
    maps.modulation_dn[i] = s.amplitude_dn[i];
    maps.cosine_dn[i] = s.amplitude_dn[i] * std::cos(s.phase_rad[i]);
    maps.sine_dn[i] = s.amplitude_dn[i] * std::sin(s.phase_rad[i]);
  }
  pipeline::correct_frame_errors(lit_spans(s), polarity, 0, {}, maps);
  return std::move(maps.phase_rad);
}

struct Unwrapped {
  pipeline::PhaseMaps phase;
  pipeline::NoiseModel noise;
  pipeline::FloodMaps flood;
  std::vector<pipeline::CellSpan> spans;
};

/// The Gray cell's middle, absolute rad of the twelve-step phase: code 2n-1 is the first half of fringe n.
double cell_middle(std::int32_t code) { return std::numbers::pi * (code + 1.5); }

/// One shift per component by vote of the Gray code: the place of a decoder's polarity code.
std::map<std::int32_t, std::int32_t> vote(const PlasterSet& set, const Unwrapped& b, double offset_rad) {
  std::map<std::int32_t, std::map<std::int32_t, int>> votes;
  for (std::size_t i = 0; i < b.phase.phase_rad.size(); ++i) {
    const std::int32_t component = b.flood.component[i];
    if (component < 0 || !(set.twelve.amplitude_dn[i] > kPlasterMinAmplitude_dn)) continue;
    const double relative = static_cast<double>(b.phase.phase_rad[i]) + kTwoPi * b.flood.wraps[i] - offset_rad;
    ++votes[component][static_cast<std::int32_t>(std::lround((cell_middle(set.half_fringe[i]) - relative) / kTwoPi))];
  }
  std::map<std::int32_t, std::int32_t> shifts;
  for (const auto& [component, counts] : votes) {
    shifts[component] = std::max_element(counts.begin(), counts.end(), [](const auto& x, const auto& y) {
                          return x.second < y.second;
                        })->first;
  }
  return shifts;
}

/// The decoder's steps up to the four-frame solution, the Gray code standing in for the polarity code.
Unwrapped unwrap(const PlasterSet& set, const FrameSet& frames, double offset_rad, pipeline::PolarityMaps& polarity) {
  Unwrapped b;
  b.noise = pipeline::noise_from_closure(frames.view());
  pipeline::compute_phase(frames.view(), b.noise, {}, b.phase);
  pipeline::reject_half_lit(b.phase.modulation_dn, b.phase.reject);
  const auto& rays = set.rays;
  const std::size_t centre = static_cast<std::size_t>(rays.height / 2 * rays.width + rays.width / 2);
  const pipeline::RaySlopes slopes{static_cast<double>(rays.c0[centre]), static_cast<double>(rays.c1[centre]),
                                   1 / set.rig.camera.fx, 1 / set.rig.camera.fy};
  pipeline::LinkMaps links;
  const pipeline::LinkConfig config;
  pipeline::compute_links(
      b.phase, pipeline::make_carrier(rays.phase_mid_rad.data(), slopes, kDepth_mm.near_mm, config.max_slope_deg),
      config, links);
  pipeline::reject_edges(links, b.phase);
  pipeline::flood(b.phase.phase_rad, links, b.flood);
  pipeline::SegmentList segments;
  pipeline::find_segments(b.phase, links, b.flood, {rays.phase_near_rad.data(), rays.phase_far_rad.data()}, {},
                          segments);
  const auto shifts = vote(set, b, offset_rad);
  for (std::size_t k = 0; k < segments.segments.size(); ++k) {
    const pipeline::Segment& p = segments.segments[k];
    const auto shift = shifts.find(p.component);
    if (shift == shifts.end()) continue;
    const bool whole = p.joined && k + 1 < segments.segments.size() && segments.segments[k + 1].joined;
    b.spans.push_back({p.row, p.begin, p.end, p.cell + 2 * shift->second, whole});
  }
  pipeline::apply_polarity(b.spans, all_plus(), b.noise, {}, b.phase, polarity);
  return b;
}

template <class Visit>
void each_pixel(const PlasterSet& set, const Unwrapped& b, Visit visit) {
  for (const pipeline::CellSpan& s : b.spans) {
    for (int u = s.begin; u < s.end; ++u) {
      const std::size_t i = b.phase.phase_rad.index(u, s.row);
      if (set.twelve.amplitude_dn[i] > kPlasterMinAmplitude_dn) visit(i);
    }
  }
}

FoldedError compare(const PlasterSet& set, const Unwrapped& b, const Map<float>& reference, double offset_rad,
                    std::vector<double>* curve) {
  ErrorFolder folder;
  each_pixel(set, b, [&](std::size_t i) {
    const auto truth = static_cast<double>(reference[i]);
    folder.add(wrap_pi(static_cast<double>(b.phase.phase_rad[i]) - offset_rad - truth), truth);
  });
  if (curve != nullptr) *curve = folder.curve();
  return folder.result();
}

void correct_all(const Unwrapped& b, const pipeline::PhaseRipple& ripple, pipeline::PhaseMaps& maps) {
  for (const pipeline::CellSpan& s : b.spans)
    pipeline::correct_phase(ripple, {&maps.phase_rad(s.begin, s.row), static_cast<std::size_t>(s.end - s.begin)});
}

void judge_surface(const PlasterSet& set, const Unwrapped& b, const pipeline::PolarityMaps& polarity, double offset_rad,
                   PlasterFigures& out) {
  const int w = set.images.width, h = set.images.height;
  out.modulation_dn = b.phase.modulation_dn;
  out.depth_mm = out.error_rad = Map<float>(w, h, kNan);
  out.order = Map<std::int32_t>(w, h, -1);
  std::vector<float> depths;
  std::map<std::int32_t, std::size_t> sizes;
  std::size_t equal = 0, literal = 0;
  each_pixel(set, b, [&](std::size_t i) {
    const double absolute = static_cast<double>(b.phase.phase_rad[i]) + kTwoPi * polarity.wraps[i] - offset_rad;
    const auto reference = static_cast<double>(set.reference_rad[i]);
    // The order that brings the reference phase nearest to the middle of its Gray cell.
    const long expected = std::lround((cell_middle(set.half_fringe[i]) - reference) / kTwoPi);
    equal += std::lround((absolute - reference) / kTwoPi) == expected ? 1U : 0U;
    out.order[i] = static_cast<std::int32_t>(std::floor(absolute / kTwoPi));
    literal += out.order[i] == (set.half_fringe[i] + 1) >> 1 ? 1U : 0U;
    out.error_rad[i] = static_cast<float>(wrap_pi(absolute - reference));
    out.depth_mm[i] = 1 / set.rays.inverse_depth(i, static_cast<float>(absolute));
    depths.push_back(out.depth_mm[i]);
    ++sizes[b.flood.component[i]];
  });
  out.solved_px = depths.size();
  if (depths.empty()) return;
  for (const auto& [component, size] : sizes)
    if (size >= 64) out.hanging_share += static_cast<double>(size) / static_cast<double>(depths.size());
  out.orders_equal = static_cast<double>(equal) / static_cast<double>(depths.size());
  out.orders_equal_literal = static_cast<double>(literal) / static_cast<double>(depths.size());
  std::sort(depths.begin(), depths.end());
  out.near_mm = static_cast<double>(depths[depths.size() / 100]);
  out.far_mm = static_cast<double>(depths[depths.size() - 1 - depths.size() / 100]);
}

}  // namespace

Result<PlasterSet> load_plaster(const std::string& folder) {
  PlasterSet set;
  ENAMEL_TRY_ASSIGN(set.images, load_fringe_images(folder, numbered("", 0, 18)));
  set.twelve = solve_steps(set.images, 12);
  set.reference_rad = corrected_reference(set.twelve);
  set.half_fringe = decode_gray(set.images, 12, 6, set.twelve.mean_dn);
  ENAMEL_TRY_ASSIGN(set.rig, load_camera_projector(folder + "/camera_projector.yml", set.images.width,
                                                   set.images.height, {1920, 1080, 60}));
  ENAMEL_TRY_ASSIGN(set.rays, pipeline::RayDepth::bake(set.rig, kDepth_mm));
  return set;
}

Result<PlasterFigures> measure_plaster(const PlasterSet& set, std::size_t burst) {
  ENAMEL_TRY_ASSIGN(const FrameSet frames, burst_of(set.images, burst, 3));
  const double offset_rad = kTwoPi * static_cast<double>(burst) / 12;
  pipeline::PolarityMaps polarity;
  Unwrapped b = unwrap(set, frames, offset_rad, polarity);
  PlasterFigures out;
  for (const float amplitude : set.twelve.amplitude_dn.pixels())
    out.reference_px += amplitude > kPlasterMinAmplitude_dn ? 1U : 0U;
  out.raw = compare(set, b, set.twelve.phase_rad, offset_rad, &out.raw_curve);

  const Map<float> uncorrected = b.phase.phase_rad;
  pipeline::PhaseRipple one;
  one.sine[0] = pipeline::level(pipeline::phase_moments(b.spans, b.phase), 1).sine[0];
  correct_all(b, one, b.phase);
  out.fourth = compare(set, b, set.twelve.phase_rad, offset_rad, nullptr);

  b.phase.phase_rad = uncorrected;
  correct_all(b, pipeline::level(pipeline::phase_moments(b.spans, b.phase)), b.phase);
  out.levelled = compare(set, b, set.twelve.phase_rad, offset_rad, nullptr);

  b.phase.phase_rad = uncorrected;
  out.frames = pipeline::correct_frame_errors(b.spans, polarity, 0, {}, b.phase);
  out.ripple = pipeline::level(pipeline::phase_moments(b.spans, b.phase));
  correct_all(b, out.ripple, b.phase);
  out.full = compare(set, b, set.reference_rad, offset_rad, &out.full_curve);
  out.full_raw = compare(set, b, set.twelve.phase_rad, offset_rad, nullptr);
  judge_surface(set, b, polarity, offset_rad, out);
  return out;
}

}  // namespace enamel::test
