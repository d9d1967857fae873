#include "host/accuracy/artefact_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace enamel::host {
namespace {

using pipeline::KnownArtefact;

constexpr double kDistance_mm = 0.5;  ///< farther from its certificate no distance of a usable scan is

/// Names balls by depth-first search: few candidates, and a distance that does not fit ends a branch.
class Naming {
 public:
  Naming(const KnownArtefact& artefact, const std::vector<std::vector<FittedBall>>& candidates)
      : artefact_(artefact), candidates_(candidates), chosen_(candidates.size(), nullptr) {
    name(0, 0);
  }
  [[nodiscard]] const std::vector<const FittedBall*>& best() const { return best_; }

 private:
  void name(std::size_t sphere, double off_mm) {
    if (off_mm >= best_off_mm_) return;
    if (sphere == candidates_.size()) {
      best_ = chosen_;
      best_off_mm_ = off_mm;
      return;
    }
    for (const FittedBall& ball : candidates_[sphere]) {
      chosen_[sphere] = &ball;
      const double more = misfit(sphere);
      if (std::isfinite(more)) name(sphere + 1, off_mm + more);
    }
    chosen_[sphere] = nullptr;
  }

  /// Of the sphere named last, with those named before it; infinite: it cannot be.
  [[nodiscard]] double misfit(std::size_t sphere) const {
    const FittedBall& ball = *chosen_[sphere];
    double sum = std::abs(ball.diameter_mm - artefact_.diameters_mm[sphere]);
    for (std::size_t other = 0; other < sphere; ++other) {
      if ((chosen_[other]->centre - ball.centre).norm() < 0.5 * artefact_.diameters_mm[sphere])
        return std::numeric_limits<double>::infinity();
    }
    for (const KnownArtefact::Distance& d : artefact_.distances) {
      if (std::max(d.i, d.j) != sphere) continue;
      const double off = std::abs((chosen_[d.i]->centre - chosen_[d.j]->centre).norm() - d.mm);
      if (off > kDistance_mm) return std::numeric_limits<double>::infinity();
      sum += off;
    }
    return sum;
  }

  const KnownArtefact& artefact_;
  const std::vector<std::vector<FittedBall>>& candidates_;
  std::vector<const FittedBall*> chosen_, best_;
  double best_off_mm_ = std::numeric_limits<double>::infinity();
};

}  // namespace

Result<ArtefactFigures> artefact_figures(const AccuracyRun& run, const KnownArtefact& artefact,
                                         const BallConfig& config) {
  std::vector<std::vector<FittedBall>> candidates;
  for (std::size_t i = 0; i < artefact.diameters_mm.size(); ++i) {
    std::vector<FittedBall> found = find_balls(run.file.mesh, artefact.diameters_mm[i], config);
    if (found.empty()) {
      return fail(ErrorCode::kMeshInvalid, fmt::format("{}: no ball of {:.3f} mm (sphere {} of the artefact) in it",
                                                       run.name, artefact.diameters_mm[i], i));
    }
    constexpr std::size_t kMost = 12;  // a surface with more balls of one size is no artefact's
    if (found.size() > kMost) found.resize(kMost);
    candidates.push_back(std::move(found));
  }
  const Naming naming(artefact, candidates);
  if (naming.best().empty())
    return fail(ErrorCode::kMeshInvalid,
                fmt::format("{}: its balls do not lie at the certified distances, to {} mm: another artefact?",
                            run.name, kDistance_mm));
  ArtefactFigures out;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const FittedBall& ball = *naming.best()[i];
    out.balls.push_back(ball);
    out.form_um.push_back(1e3 * ball.form_mm);
    out.size_um.push_back(1e3 * (ball.diameter_mm - artefact.diameters_mm[i]));
  }
  for (const KnownArtefact::Distance& d : artefact.distances)
    out.distance_um.push_back(1e3 * ((out.balls[d.i].centre - out.balls[d.j].centre).norm() - d.mm));
  return out;
}

}  // namespace enamel::host
