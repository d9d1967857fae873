#include "calib/target/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <utility>

#include "calib/target/homography.hpp"

namespace enamel::calib {
namespace {

using Eigen::Vector2d;

constexpr double kNearPrediction = 0.3;  // of the shorter axis: neighbour found by extrapolation
constexpr double kNearLattice = 0.15;    // of a cell: point completed by the homography
constexpr double kMinSine = 0.6;         // between the two axes of a cell

struct Cell {
  int point = 0;
  Vector2d a{0, 0}, b{0, 0};  // steps to the next columns and rows here
};

class Grower {
 public:
  Grower(std::span<const Vector2d> points, const std::vector<bool>& taken) : points_(points), taken_(taken) {}

  std::vector<LatticePoint> grow(const Vector2d& start) {
    const auto seed = nearest(start, 1e9, -1);
    if (!seed) return {};
    const auto axes = first_axes(*seed);
    if (!axes) return {};
    cells_[{0, 0}] = {*seed, axes->first, axes->second};
    used_.assign(points_.size(), false);
    used_[static_cast<std::size_t>(*seed)] = true;
    spread();
    complete();
    std::vector<LatticePoint> out;
    for (const auto& [at, cell] : cells_) out.push_back({cell.point, at.first, at.second});
    return out;
  }

 private:
  std::optional<int> nearest(const Vector2d& p, double within, int except) const {
    std::optional<int> best;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double d = (points_[i] - p).norm();
      if (taken_[i] || static_cast<int>(i) == except || d >= within) continue;
      best = static_cast<int>(i);
      within = d;
    }
    return best;
  }

  /// The shortest step to a neighbour and the shortest one across it.
  std::optional<std::pair<Vector2d, Vector2d>> first_axes(int seed) const {
    const Vector2d origin = points_[static_cast<std::size_t>(seed)];
    std::vector<Vector2d> steps;
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (!taken_[i] && static_cast<int>(i) != seed) steps.push_back(points_[i] - origin);
    std::stable_sort(steps.begin(), steps.end(),
                     [](const Vector2d& p, const Vector2d& q) { return p.squaredNorm() < q.squaredNorm(); });
    for (std::size_t i = 1; i < steps.size(); ++i) {
      const double cross = steps[0].x() * steps[i].y() - steps[0].y() * steps[i].x();
      if (std::abs(cross) > kMinSine * steps[0].norm() * steps[i].norm()) return std::pair{steps[0], steps[i]};
    }
    return {};
  }

  void spread() {
    std::deque<std::pair<int, int>> open{{0, 0}};
    constexpr std::pair<int, int> kSteps[] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    while (!open.empty()) {
      const auto at = open.front();
      open.pop_front();
      for (const auto& [da, db] : kSteps) {
        const Cell here = cells_.at(at);
        const std::pair<int, int> to{at.first + da, at.second + db};
        if (cells_.contains(to)) continue;
        const Vector2d step = da * here.a + db * here.b;
        const Vector2d origin = points_[static_cast<std::size_t>(here.point)];
        const auto found = nearest(origin + step, kNearPrediction * std::min(here.a.norm(), here.b.norm()), here.point);
        if (!found || used_[static_cast<std::size_t>(*found)]) continue;
        Cell next{*found, here.a, here.b};
        const Vector2d moved = points_[static_cast<std::size_t>(*found)] - origin;
        (da != 0 ? next.a : next.b) = da + db > 0 ? moved : Vector2d(-moved);
        used_[static_cast<std::size_t>(*found)] = true;
        cells_[to] = next;
        open.push_back(to);
      }
    }
  }

  /// Points beyond a gap: where the homography of what was found puts them near a free lattice place.
  void complete() {
    std::vector<Vector2d> image, lattice;
    for (const auto& [at, cell] : cells_) {
      image.push_back(points_[static_cast<std::size_t>(cell.point)]);
      lattice.emplace_back(at.first, at.second);
    }
    const auto to_lattice = fit_homography(image, lattice);
    if (!to_lattice) return;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (used_[i] || taken_[i]) continue;
      const Vector2d p = map_point(*to_lattice, points_[i]);
      if (!(p.cwiseAbs().maxCoeff() < 1000)) continue;
      const std::pair<int, int> at{static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))};
      if ((p - Vector2d(at.first, at.second)).norm() > kNearLattice || cells_.contains(at)) continue;
      cells_[at] = {static_cast<int>(i), Vector2d::Zero(), Vector2d::Zero()};
      used_[i] = true;
    }
  }

  std::span<const Vector2d> points_;
  const std::vector<bool>& taken_;
  std::vector<bool> used_;
  std::map<std::pair<int, int>, Cell> cells_;
};

}  // namespace

std::vector<LatticePoint> grow_lattice(std::span<const Vector2d> points, const std::vector<bool>& taken,
                                       const Vector2d& start) {
  return Grower(points, taken).grow(start);
}

}  // namespace enamel::calib
