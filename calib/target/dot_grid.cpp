#include "calib/target/dot_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "calib/target/blobs.hpp"
#include "calib/target/coded_grid.hpp"
#include "calib/target/lattice.hpp"

namespace enamel::calib {
namespace {

using Eigen::Vector2d;

constexpr double kStrayLine = 0.34;    // an outermost line with fewer of its dots is no line of the target
constexpr double kSecondTarget = 0.5;  // of the dots: a second lattice of this size is another target
constexpr int kMinBlobs = 6;

struct Extent {
  int a0 = 0, a1 = -1, b0 = 0, b1 = -1;
  [[nodiscard]] int across_a() const { return a1 - a0 + 1; }
  [[nodiscard]] int across_b() const { return b1 - b0 + 1; }
};

Extent extent_of(const std::vector<LatticePoint>& lattice) {
  Extent e{std::numeric_limits<int>::max(), std::numeric_limits<int>::min(), std::numeric_limits<int>::max(),
           std::numeric_limits<int>::min()};
  for (const LatticePoint& p : lattice)
    e = {std::min(e.a0, p.a), std::max(e.a1, p.a), std::min(e.b0, p.b), std::max(e.b1, p.b)};
  return e;
}

/// Drops outermost lines that hold only stray blobs, as long as there are any.
void trim_strays(std::vector<LatticePoint>& lattice) {
  for (bool changed = true; changed && !lattice.empty();) {
    changed = false;
    const Extent e = extent_of(lattice);
    const auto drop_line = [&](auto is_on, int full) {
      const auto n = std::count_if(lattice.begin(), lattice.end(), is_on);
      if (static_cast<double>(n) >= kStrayLine * full) return;
      std::erase_if(lattice, is_on);
      changed = true;
    };
    drop_line([&](const LatticePoint& p) { return p.a == e.a0; }, e.across_b());
    drop_line([&](const LatticePoint& p) { return p.a == e.a1; }, e.across_b());
    drop_line([&](const LatticePoint& p) { return p.b == e.b0; }, e.across_a());
    drop_line([&](const LatticePoint& p) { return p.b == e.b1; }, e.across_a());
  }
}

/// One way to lay the lattice on the target: which lattice axis is the columns, and in which sense each runs.
struct Layout {
  bool swapped = false, flip_col = false, flip_row = false;

  [[nodiscard]] GridIndex place(const LatticePoint& p, const Extent& e) const {
    const int a = p.a - e.a0, b = p.b - e.b0;
    GridIndex g = swapped ? GridIndex{b, a} : GridIndex{a, b};
    const int last_col = (swapped ? e.across_b() : e.across_a()) - 1;
    const int last_row = (swapped ? e.across_a() : e.across_b()) - 1;
    if (flip_col) g.col = last_col - g.col;
    if (flip_row) g.row = last_row - g.row;
    return g;
  }
};

/// Mean image direction of growing column and row under a layout.
std::pair<Vector2d, Vector2d> directions(const std::vector<LatticePoint>& lattice, const Extent& e,
                                         const std::vector<Blob>& blobs, const Layout& layout) {
  Vector2d mean(0, 0), grid_mean(0, 0);
  for (const LatticePoint& p : lattice) {
    const GridIndex g = layout.place(p, e);
    mean += blobs[static_cast<std::size_t>(p.point)].ellipse.centre;
    grid_mean += Vector2d(g.col, g.row);
  }
  mean /= static_cast<double>(lattice.size());
  grid_mean /= static_cast<double>(lattice.size());
  Vector2d x(0, 0), y(0, 0);
  for (const LatticePoint& p : lattice) {
    const GridIndex g = layout.place(p, e);
    const Vector2d d = blobs[static_cast<std::size_t>(p.point)].ellipse.centre - mean;
    x += (g.col - grid_mean.x()) * d;
    y += (g.row - grid_mean.y()) * d;
  }
  return {x, y};
}

bool rings_fit(const std::vector<LatticePoint>& lattice, const Extent& e, const std::vector<Blob>& blobs,
               const Layout& layout, const TargetDesign& target) {
  for (const LatticePoint& p : lattice) {
    const GridIndex g = layout.place(p, e);
    const bool marked = std::any_of(target.marks.begin(), target.marks.end(),
                                    [&](const GridIndex& m) { return m.col == g.col && m.row == g.row; });
    if (marked != blobs[static_cast<std::size_t>(p.point)].has_hole) return false;
  }
  return true;
}

/// Columns right and rows up in the image (z faces the camera), or where the rings say.
Result<Layout> choose_layout(const std::vector<LatticePoint>& lattice, const Extent& e, const std::vector<Blob>& blobs,
                             const TargetDesign& target) {
  std::optional<Layout> best;
  double best_slope = -2;
  for (const bool swapped : {false, true}) {
    const int cols = swapped ? e.across_b() : e.across_a();
    const int rows = swapped ? e.across_a() : e.across_b();
    if (cols != target.cols || rows != target.rows) continue;
    for (const bool flip_col : {false, true}) {
      for (const bool flip_row : {false, true}) {
        const Layout layout{swapped, flip_col, flip_row};
        const auto [x, y] = directions(lattice, e, blobs, layout);
        if (x.x() * y.y() - x.y() * y.x() > 0) continue;  // v runs down: seen from behind
        if (!target.marks.empty() && !rings_fit(lattice, e, blobs, layout, target)) continue;
        const double slope = x.x() / x.norm();
        if (slope <= best_slope) continue;
        best = layout;
        best_slope = slope;
      }
    }
  }
  if (best) return *best;
  if (!target.marks.empty() && (e.across_a() == target.cols || e.across_b() == target.cols)) {
    return fail(ErrorCode::kTargetNotFound,
                "a grid of the right size is in view but its rings are not where the key 'marks' of target.json says");
  }
  const int few = std::min(e.across_a(), e.across_b()), many = std::max(e.across_a(), e.across_b());
  const bool wide = target.cols >= target.rows;
  return fail(ErrorCode::kTargetNotFound, fmt::format("a grid of {} x {} dots is in view, target.json says {} x {}",
                                                      wide ? many : few, wide ? few : many, target.cols, target.rows));
}

}  // namespace

Result<DotGrid> find_dot_grid(const Map<float>& image, const TargetDesign& target) {
  if (target.type == TargetType::kCodedDots) return find_coded_grid(image, target);
  const std::vector<Blob> blobs = find_blobs(image, target.is_white_on_dark);
  if (static_cast<int>(blobs.size()) < kMinBlobs) {
    return fail(ErrorCode::kTargetNotFound,
                fmt::format("{} round dots in view, target.json says {} x {}", blobs.size(), target.cols, target.rows));
  }
  std::vector<Vector2d> points;
  Vector2d middle(0, 0);
  for (const Blob& b : blobs) {
    points.push_back(b.ellipse.centre);
    middle += b.ellipse.centre / static_cast<double>(blobs.size());
  }
  std::vector<bool> taken(points.size(), false);
  std::vector<LatticePoint> lattice = grow_lattice(points, taken, middle);
  for (const LatticePoint& p : lattice) taken[static_cast<std::size_t>(p.point)] = true;
  if (static_cast<double>(grow_lattice(points, taken, middle).size()) >= kSecondTarget * target.size())
    return fail(ErrorCode::kTargetAmbiguous, "two grids of dots are in view");
  trim_strays(lattice);
  if (lattice.empty()) return fail(ErrorCode::kTargetNotFound, "the dots in view form no grid");
  const Extent extent = extent_of(lattice);
  ENAMEL_TRY_ASSIGN(const Layout layout, choose_layout(lattice, extent, blobs, target));
  DotGrid grid;
  for (const LatticePoint& p : lattice)
    grid.dots.push_back({target.index(layout.place(p, extent)), blobs[static_cast<std::size_t>(p.point)].ellipse});
  std::sort(grid.dots.begin(), grid.dots.end(), [](const GridDot& p, const GridDot& q) { return p.index < q.index; });
  grid.spacing_px = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < grid.dots.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      grid.spacing_px = std::min(grid.spacing_px, (grid.dots[i].blob.centre - grid.dots[j].blob.centre).norm());
  }
  return grid;
}

}  // namespace enamel::calib
