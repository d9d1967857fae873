// Fringe orders by the model (docs/decode.md §4): once a burst is placed, the model foretells the depth of what it has
// seen before, and neighbouring orders are millimetres apart. It decides regions that the code left open, and it is the
// standing check of what the code decided: where both disagree, the code was misread or the burst stands in the wrong
// place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pipeline/decode/triangulate/ray_depth.hpp"
#include "pipeline/model/guide/model_sight.hpp"
#include "pipeline/types/order_check.hpp"
#include "pipeline/types/patch.hpp"
#include "pipeline/types/relative_surface.hpp"

namespace enamel::pipeline {

struct GuideConfig {
  double tolerance_mm =
      0.25;                 ///< to the model's tangent plane; poses are known ten times better, orders lie 3 mm apart
  int min_votes = 64;       ///< pixels of a region that must lie on the model with one order
  int min_span_votes = 6;   ///< and of a span, where the region holds a jump of whole turns and spans go their own way
  double min_share = 0.67;  ///< of the pixels whose ray meets the model, those that must lie on it with one order …
  double min_agreement = 0.95;    ///< … and, of those that lie on it with any order, with this one
  int check_step_px = 4;          ///< of the pixels that are cross-checked, in u and v
  double suspect_share = 0.01;    ///< more contradiction between code and model than this puts the placement in doubt
  std::size_t min_checked = 500;  ///< fewer say nothing about a share
};

/// Memory that ModelGuide::decide works in.
struct GuideVotes {
  std::vector<std::int32_t> pixels;   ///< of each pixel; in the end its order
  std::vector<std::int32_t> orders;   ///< of each order of each region
  std::vector<std::size_t> first;     ///< of `orders`, for each region
  std::vector<std::int32_t> seen;     ///< of each region: all that see the model
  std::vector<std::int32_t> of_span;  ///< of each order, of one span
};

/// Immutable, thread-safe. view.empty: nothing is decided, nothing checked.
class ModelGuide {
 public:
  ModelGuide(std::shared_ptr<const RayDepth> rays, const calib::LensValues& camera, const GuideConfig& config);

  /// The order k of each pixel of `relative`, or kOpenOrder: that of its region where the region agrees; where a jump
  /// of whole turns lies inside, that of its span, for the pixels that lie on the model with it.
  [[nodiscard]] std::vector<std::int32_t> decide(const RelativeSurface& relative, const ModelView& view,
                                                 const Pose& T_model_cam) const;
  /// The same in memory that is used again: votes.pixels.
  [[nodiscard]] std::span<const std::int32_t> decide(const RelativeSurface& relative, const ModelView& view,
                                                     const Pose& T_model_cam, GuideVotes& votes) const;

  /// What the code decided beside what the model shows. Pixels on the model agree; those that would lie on it with
  /// another order contradict; all others (new surface, moving tissue) are not counted.
  [[nodiscard]] OrderCheck check(const SurfacePatch& patch, const ModelView& view, const Pose& T_model_cam) const;

  /// Takes the contradicting pixels out of the patch: neither side is believed. Returns their number.
  std::size_t withdraw(const ModelView& view, const Pose& T_model_cam, SurfacePatch& patch) const;

  [[nodiscard]] const RayDepth& rays() const noexcept { return *rays_; }

 private:
  enum class Stand : std::uint8_t { kAgrees, kContradicts, kNew };
  [[nodiscard]] Stand stand_of(const ModelSight& sight, std::size_t pixel, float depth_mm) const;
  [[nodiscard]] bool lies_on_another_order(const ModelSight& sight, std::size_t pixel, float depth_mm) const;

  std::shared_ptr<const RayDepth> rays_;
  ViewCamera camera_;
  GuideConfig config_;
};

}  // namespace enamel::pipeline
