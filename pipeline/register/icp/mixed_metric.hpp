// The mixed metric: one pass of ICP that sums point-to-plane and point-to-point terms.
//
//   E = sum w [ lambda (n . e)^2 + (1 - lambda) |e|^2 ],   e = R p + t - q
//
// q is the closest point of the reference, not the one on p's own ray: a projective match lies along the view for both
// terms and holds nothing sideways. After Rusinkiewicz 2001; rim matches are left out as in Turk & Levoy 1994.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/register/icp/accumulate.hpp"

namespace enamel::pipeline {

struct MatchConfig {
  bool closest = true;  ///< false: the pixel on the sample's own ray, as accumulate() takes it
  bool rim = false;     ///< true: also pixels that have unusable neighbours or none
};

/// The usable pixels of a reference, asked for the one closest to a point. Refers to the reference. Thread-safe.
class ClosestPoints {
 public:
  ClosestPoints(const Reference& reference, const ViewCamera& camera, const MatchConfig& config);

  static constexpr std::int32_t kNone = -1;
  struct Match {
    std::int32_t pixel = kNone;
    std::int32_t on_ray = kNone;  ///< the pixel that the point falls on, usable or not; kNone: beyond the view
  };
  /// The closest usable pixel within reach_mm of a point that falls into the view, exact over the whole view; kNone
  /// also where that pixel lies on the rim, for what continues the surface there was not measured. in_view, in_model:
  /// the point in the reference's camera and in its model frame, mm.
  [[nodiscard]] Match match(const Vec3f& in_view, const Vec3f& in_model, float reach_mm) const;

 private:
  struct Search;
  void look_at_ring(int radius, Search& search) const;
  [[nodiscard]] bool on_rim(int u, int v) const;

  const Reference& reference_;
  ViewCamera camera_;
  MatchConfig config_;
  std::vector<std::uint8_t> rim_;
};

struct MixedTerm {
  const ClosestPoints& closest;
  double lambda = 1;  ///< 0 … 1: share of the plane term; 1: plain point to plane
};

/// As accumulate(). gate.distance3d_mm is how far the closest point is sought; AlignPass::weighted_e2 is E.
[[nodiscard]] AlignPass accumulate_mixed(const Alignment& of, const MixedTerm& term, const Pose& T_model_cam,
                                         const MatchGate& gate, const RobustKernel& kernel);

}  // namespace enamel::pipeline
