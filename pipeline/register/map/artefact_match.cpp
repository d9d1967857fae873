#include "pipeline/register/map/artefact_match.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace enamel::pipeline {
namespace {

/// Certified, of two balls by number; null where the certificate says nothing.
const KnownArtefact::Distance* distance_of(const KnownArtefact& artefact, std::size_t i, std::size_t j) {
  for (const auto& d : artefact.distances) {
    if (std::minmax(d.i, d.j) == std::minmax(i, j)) return &d;
  }
  return nullptr;
}

using Names = std::vector<std::size_t>;

class Search {
 public:
  Search(const std::vector<BallCluster>& clusters, const KnownArtefact& artefact, double tolerance_mm)
      : clusters_(clusters), artefact_(artefact), tolerance_(tolerance_mm) {
    name(0, 0);
  }
  [[nodiscard]] const Names& best() const { return best_; }
  [[nodiscard]] double worst_mm() const { return worst_; }
  [[nodiscard]] bool is_ambiguous() const {
    return std::ranges::any_of(fitting_, [&](const Names& other) { return !ties_alike(best_, other); });
  }

 private:
  /// Names cluster k and all behind it; `worst`: how far the distances among those before are off.
  void name(std::size_t k, double worst) {
    if (worst > std::max(tolerance_, worst_)) return;
    if (k == clusters_.size()) {
      if (worst <= tolerance_) fitting_.push_back(names_);
      if (worst < worst_ || best_.empty()) best_ = names_, worst_ = worst;
      return;
    }
    for (std::size_t sphere = 0; sphere < artefact_.diameters_mm.size(); ++sphere) {
      if (std::ranges::find(names_, sphere) != names_.end() || !is_of_size(k, sphere)) continue;
      double off = worst;
      for (std::size_t m = 0; m < k; ++m) {
        const auto* d = distance_of(artefact_, names_[m], sphere);
        if (d != nullptr) off = std::max(off, std::abs((clusters_[m].centre - clusters_[k].centre).norm() - d->mm));
      }
      names_.push_back(sphere);
      name(k + 1, off);
      names_.pop_back();
    }
  }
  [[nodiscard]] bool is_of_size(std::size_t k, std::size_t sphere) const {
    return std::abs(2 * clusters_[k].radius_mm - artefact_.diameters_mm[sphere]) < kSameDiameter_mm;
  }
  /// Both put the same distance between every two clusters, within what is certified.
  [[nodiscard]] bool ties_alike(const Names& a, const Names& b) const {
    for (std::size_t k = 0; k < a.size(); ++k) {
      for (std::size_t m = 0; m < k; ++m) {
        const auto* one = distance_of(artefact_, a[k], a[m]);
        const auto* two = distance_of(artefact_, b[k], b[m]);
        if (one == two) continue;
        if (one == nullptr || two == nullptr) return false;
        if (std::abs(one->mm - two->mm) > std::hypot(one->sigma_mm, two->sigma_mm)) return false;
      }
    }
    return true;
  }

  const std::vector<BallCluster>& clusters_;
  const KnownArtefact& artefact_;
  double tolerance_;
  Names names_, best_;
  std::vector<Names> fitting_;
  double worst_ = std::numeric_limits<double>::infinity();
};

}  // namespace

std::vector<BallCluster> cluster_balls(const std::vector<std::vector<FoundSphere>>& of_keyframe,
                                       const std::vector<Pose>& T_model_cam, double reach_mm) {
  std::vector<BallCluster> out;
  for (std::size_t k = 0; k < of_keyframe.size(); ++k) {
    for (const FoundSphere& sphere : of_keyframe[k]) {
      const Vec3d at = T_model_cam[k] * sphere.centre;
      auto cluster = std::ranges::find_if(out, [&](const BallCluster& c) {
        return c.radius_mm == sphere.radius_mm && (c.centre - at).norm() < reach_mm;
      });
      if (cluster == out.end()) cluster = out.insert(out.end(), {at, sphere.radius_mm, {}});
      cluster->seen.push_back({k, sphere});
      cluster->centre += (at - cluster->centre) / static_cast<double>(cluster->seen.size());
    }
  }
  return out;
}

BallMatch match_balls(const std::vector<BallCluster>& clusters, const KnownArtefact& artefact, double tolerance_mm) {
  const std::string seen = std::to_string(clusters.size()) + " spheres seen";
  if (clusters.size() < 2) return {{}, seen + ", two are needed: guide the probe over them, three pictures each"};
  if (clusters.size() > artefact.diameters_mm.size())
    return {{}, seen + ", more than certified: the artefact has moved, or is another one"};
  const Search search(clusters, artefact, tolerance_mm);
  if (search.best().empty()) return {{}, seen + " whose diameters fit no choice of certified ones"};
  if (search.worst_mm() > tolerance_mm) {
    return {{},
            seen + " whose distances contradict the certificate by " + mm_text(search.worst_mm()) +
                " mm: the artefact has moved, or is another one"};
  }
  if (search.is_ambiguous())
    return {{}, seen + " that could be named in more than one way: show more of them, or use one without symmetry"};
  const Names& names = search.best();
  for (std::size_t k = 0; k < names.size(); ++k) {
    for (std::size_t m = 0; m < k; ++m) {
      if (distance_of(artefact, names[k], names[m]) != nullptr) return {names, {}};
    }
  }
  return {{}, seen + " between which no distance is certified"};
}

}  // namespace enamel::pipeline
