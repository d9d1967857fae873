#include "pipeline/model/guide/model_guide.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "pipeline/model/guide/ray_point.hpp"

namespace enamel::pipeline {
namespace {

constexpr float kTurn = 2 * std::numbers::pi_v<float>;

constexpr std::int32_t kUnseen = -2, kOffTheModel = -1, kAtAnEdge = -3;

/// Calls visit(k, point) for each order of the region that is in range at the pixel.
template <class Visit>
void each_order(const RayDepth& rays, std::size_t pixel, float phase_rad, const RelativeSurface::Region& region,
                Visit visit) {
  for (std::int32_t k = region.low; k <= region.high; ++k) {
    const float q = rays.inverse_depth(pixel, phase_rad + kTurn * static_cast<float>(k));
    if (in_range(rays, q)) visit(k - region.low, point_at(rays, pixel, 1 / q));
  }
}

/// Which order, counted from the region's lowest, brings a pixel nearest to the model. None where the model has an
/// edge and another order would bring it there just as well.
std::int32_t vote(const RayDepth& rays, const ModelSight& sight, std::size_t pixel, float phase_rad,
                  const RelativeSurface::Region& region, float tolerance_mm) {
  std::int32_t best = kUnseen;
  float least = tolerance_mm;
  each_order(rays, pixel, phase_rad, region, [&](std::int32_t k, const Vec3f& p) {
    const float d = sight.distance_mm(p);
    if (best == kUnseen && std::isfinite(d)) best = kOffTheModel;
    if (d < least) least = d, best = k;
  });
  if (best < 0) return best;
  bool edge = false;
  each_order(rays, pixel, phase_rad, region, [&](std::int32_t k, const Vec3f& p) {
    edge = edge || (k != best && sight.distance_beside_mm(p) < tolerance_mm);
  });
  return edge ? kAtAnEdge : best;
}

/// Votes of many pixels.
struct Tally {
  std::span<std::int32_t> of;  ///< each order
  std::int32_t seen = 0;       ///< all that see the model

  void add(std::int32_t vote) {
    seen += vote != kUnseen ? 1 : 0;
    if (vote >= 0) ++of[static_cast<std::size_t>(vote)];
  }
  /// The order that is agreed on.
  [[nodiscard]] std::optional<std::int32_t> agreed(std::int32_t least, const GuideConfig& config) const {
    const auto most = std::max_element(of.begin(), of.end());
    if (most == of.end() || *most < least) return std::nullopt;
    const double all = std::accumulate(of.begin(), of.end(), 0.0);
    if (*most < config.min_share * seen || *most < config.min_agreement * all) return std::nullopt;
    return static_cast<std::int32_t>(most - of.begin());
  }
};

Tally tally_of(GuideVotes& votes, std::size_t region) {
  const std::size_t first = votes.first[region];
  return {std::span(votes.orders).subspan(first, votes.first[region + 1] - first), votes.seen[region]};
}

std::size_t orders_of(const RelativeSurface::Region& region) {
  return static_cast<std::size_t>(std::max(0, region.high - region.low + 1));
}

/// Pixels at the span's front that do not see the model, if they are so few that only the view's blank along an edge
/// may lie there; else 0.
template <class Votes>
std::ptrdiff_t blank_edge(Votes begin, Votes end, std::ptrdiff_t most_px) {
  const auto blank = std::find_if(begin, end, [](std::int32_t v) { return v != kUnseen; }) - begin;
  return blank <= most_px ? blank : 0;
}

/// What a span in a region of several orders agrees on by itself. scratch: see GuideVotes::of_span.
std::optional<std::int32_t> own_order(const Tally& region, const GuideConfig& config,
                                      std::span<const std::int32_t> votes, std::vector<std::int32_t>& scratch) {
  scratch.assign(region.of.size(), 0);
  Tally own{scratch};
  for (const std::int32_t v : votes) own.add(v);
  const auto order = own.agreed(config.min_span_votes, config);
  return order && region.of[static_cast<std::size_t>(*order)] >= config.min_votes ? order : std::nullopt;
}

/// Votes of a span's pixels into orders. edge_px: what the view leaves blank along an edge of the model.
void settle(const Tally& region, std::int32_t low, const GuideConfig& config, int edge_px,
            std::span<std::int32_t> votes, std::vector<std::int32_t>& scratch) {
  const auto whole = region.agreed(config.min_votes, config);
  const std::int32_t order = (whole ? whole : own_order(region, config, votes, scratch)).value_or(kOpenOrder);
  const auto front = blank_edge(votes.begin(), votes.end(), edge_px);
  const auto back = blank_edge(votes.rbegin(), votes.rend(), edge_px);
  // In a region that agrees, pixels beside the model join it; nowhere does one that is for another order.
  for (std::int32_t& v : votes)
    v = v == order || (whole && (v == kUnseen || v == kOffTheModel)) ? low + order : kOpenOrder;
  // A strip of the surface beyond the model's edge may hang on there, where the view cannot tell.
  std::fill_n(votes.begin(), front, kOpenOrder);
  std::fill_n(votes.rbegin(), back, kOpenOrder);
}

}  // namespace

ModelGuide::ModelGuide(std::shared_ptr<const RayDepth> rays, const calib::LensValues& camera, const GuideConfig& config)
    : rays_(std::move(rays)), camera_(camera), config_(config) {}

std::vector<std::int32_t> ModelGuide::decide(const RelativeSurface& relative, const ModelView& view,
                                             const Pose& T_model_cam) const {
  GuideVotes votes;
  (void)decide(relative, view, T_model_cam, votes);
  return std::move(votes.pixels);
}

std::span<const std::int32_t> ModelGuide::decide(const RelativeSurface& relative, const ModelView& view,
                                                 const Pose& T_model_cam, GuideVotes& votes) const {
  votes.pixels.assign(relative.phase_rad.size(), kOpenOrder);
  if (view.empty) return votes.pixels;
  const ModelSight sight(view, camera_, T_model_cam);
  votes.first.assign(1, 0);
  for (const auto& region : relative.regions) votes.first.push_back(votes.first.back() + orders_of(region));
  votes.orders.assign(votes.first.back(), 0);
  votes.seen.assign(relative.regions.size(), 0);
  std::size_t n = 0;
  for (const auto& span : relative.spans) {
    const auto r = static_cast<std::size_t>(span.region);
    const std::size_t row = static_cast<std::size_t>(span.row) * static_cast<std::size_t>(rays_->width);
    Tally tally = tally_of(votes, r);
    for (std::int32_t u = span.begin; u < span.end; ++u, ++n) {
      const float phase = relative.phase_rad[n] + kTurn * static_cast<float>(span.wraps);
      votes.pixels[n] = vote(*rays_, sight, row + static_cast<std::size_t>(u), phase, relative.regions[r],
                             static_cast<float>(config_.tolerance_mm));
      tally.add(votes.pixels[n]);
    }
    votes.seen[r] = tally.seen;
  }
  std::size_t first = 0;
  for (const auto& span : relative.spans) {
    const auto r = static_cast<std::size_t>(span.region);
    const std::span<std::int32_t> own(&votes.pixels[first], static_cast<std::size_t>(span.end - span.begin));
    settle(tally_of(votes, r), relative.regions[r].low, config_, 2 * view.stride, own, votes.of_span);
    first += own.size();
  }
  return votes.pixels;
}

bool ModelGuide::lies_on_another_order(const ModelSight& sight, std::size_t pixel, float depth_mm) const {
  const RayDepth& rays = *rays_;
  // The cubic undone by Newton from the middle of the range: 1/z is all but linear in the phase.
  float phase = rays.phase_mid_rad[pixel];
  for (int k = 0; k < 3; ++k)
    phase += (1 / depth_mm - rays.inverse_depth(pixel, phase)) / rays.inverse_depth_slope(pixel, phase);
  for (const float step : {kTurn, -kTurn}) {
    for (float other = phase + step;; other += step) {
      const float q = rays.inverse_depth(pixel, other);
      if (!in_range(rays, q)) break;
      if (sight.distance_mm(point_at(rays, pixel, 1 / q)) < static_cast<float>(config_.tolerance_mm)) return true;
    }
  }
  return false;
}

ModelGuide::Stand ModelGuide::stand_of(const ModelSight& sight, std::size_t pixel, float depth_mm) const {
  const float d = sight.distance_mm(point_at(*rays_, pixel, depth_mm));
  if (d < static_cast<float>(config_.tolerance_mm)) return Stand::kAgrees;
  // The view is from nearly the same place: where it shows nothing here, it shows nothing at other depths of the ray.
  if (!std::isfinite(d)) return Stand::kNew;
  return lies_on_another_order(sight, pixel, depth_mm) ? Stand::kContradicts : Stand::kNew;
}

OrderCheck ModelGuide::check(const SurfacePatch& patch, const ModelView& view, const Pose& T_model_cam) const {
  OrderCheck out;
  if (view.empty) return out;
  const ModelSight sight(view, camera_, T_model_cam);
  for (int v = 0; v < rays_->height; v += config_.check_step_px) {
    for (int u = 0; u < rays_->width; u += config_.check_step_px) {
      const std::size_t i = patch.depth_mm.index(u, v);
      if (std::isnan(patch.depth_mm[i])) continue;
      const Stand stand = stand_of(sight, i, patch.depth_mm[i]);
      out.checked += stand != Stand::kNew ? 1U : 0U;
      out.contradicting += stand == Stand::kContradicts ? 1U : 0U;
    }
  }
  out.suspect = out.checked >= config_.min_checked && out.share() > config_.suspect_share;
  return out;
}

std::size_t ModelGuide::withdraw(const ModelView& view, const Pose& T_model_cam, SurfacePatch& patch) const {
  if (view.empty) return 0;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const ModelSight sight(view, camera_, T_model_cam);
  std::size_t withdrawn = 0;
  for (std::size_t i = 0; i < patch.depth_mm.size(); ++i) {
    if (std::isnan(patch.depth_mm[i]) || stand_of(sight, i, patch.depth_mm[i]) != Stand::kContradicts) continue;
    patch.depth_mm[i] = patch.sigma_mm[i] = kNan;
    patch.points[i] = patch.normals[i] = Vec3f::Constant(kNan);
    ++withdrawn;
  }
  patch.valid_px -= withdrawn;
  return withdrawn;
}

}  // namespace enamel::pipeline
