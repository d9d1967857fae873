#include "calib/target/coded_grid.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "calib/target/blobs.hpp"
#include "calib/target/homography.hpp"
#include "calib/target/lattice.hpp"

namespace enamel::calib {
namespace {

using Eigen::Vector2d;

constexpr double kChance = 1e-6;             // of a placement by random bits
constexpr int kMargin = 4;                   // bits that the next best placement contradicts beyond the best one
constexpr int kSecondLattice = 16;           // dots: so many beyond the first lattice are another board
constexpr double kRing = 0.35, kDot = 0.65;  // light of the middle over that of the rim, ground taken off
constexpr double kOnPlane = 0.15;  // of a pitch: a spot farther from the homography of all is no dot of the board

struct Turn {
  int ca, cb, ra, rb;
};
constexpr std::array<Turn, 4> kTurns{{{1, 0, 0, 1}, {0, 1, -1, 0}, {-1, 0, 0, -1}, {0, -1, 1, 0}}};

/// Mean of the pixels with low < radius < high, radii in units of the ellipse.
double mean_between(const Map<float>& image, const Ellipse& e, double low, double high) {
  const int reach = static_cast<int>(std::ceil(high * e.half_axes().x())) + 1;
  const int cu = static_cast<int>(std::lround(e.centre.x())), cv = static_cast<int>(std::lround(e.centre.y()));
  double sum = 0;
  int n = 0;
  for (int v = cv - reach; v <= cv + reach; ++v) {
    for (int u = cu - reach; u <= cu + reach; ++u) {
      if (!image.contains(u, v)) continue;
      const double radius = e.radius_at({u, v});
      if (radius < low || radius > high) continue;
      sum += static_cast<double>(image(u, v));
      ++n;
    }
  }
  return n > 0 ? sum / n : std::numeric_limits<double>::quiet_NaN();
}

int bit_of(const Map<float>& image, const Ellipse& e, double inner_share) {
  const double middle = 0.5 * (1 + inner_share), half = 0.15 * (1 - inner_share);
  const double rim = mean_between(image, e, middle - half, middle + half);
  const double ground = mean_between(image, e, 1.25, 1.45);
  const double centre = mean_between(image, e, 0, 0.5 * inner_share);
  const double share = (centre - ground) / (rim - ground);
  if (!(std::abs(rim - ground) > 1) || !std::isfinite(share)) return -1;
  return share < kRing ? 1 : share > kDot ? 0 : -1;
}

/// Probability that n random bits contradict at most `wrong` of n.
double chance(int n, int wrong) {
  double sum = 0;
  for (int k = 0; k <= wrong; ++k)
    sum += std::exp(std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1) - n * std::log(2.0));
  return sum;
}

struct Search {
  std::optional<CodePlacement> best;
  int next_wrong = std::numeric_limits<int>::max();
  int read = 0;
  double by_chance = 1;  ///< expected number of placements as good as the best one among random maps

  [[nodiscard]] bool is_certain() const { return best && by_chance < kChance && next_wrong >= best->wrong + kMargin; }
};

Search search(const std::vector<CodedDot>& dots, const TargetDesign& target) {
  Search out;
  for (const CodedDot& d : dots) out.read += d.bit >= 0 ? 1 : 0;
  const int reach = std::max(target.cols, target.rows);
  int a0 = 0, a1 = 0, b0 = 0, b1 = 0;
  for (const CodedDot& d : dots) {
    a0 = std::min(a0, d.a), a1 = std::max(a1, d.a);
    b0 = std::min(b0, d.b), b1 = std::max(b1, d.b);
  }
  const int far = reach + std::max({-a0, a1, -b0, b1});
  for (const Turn& t : kTurns) {
    for (int r0 = -far; r0 <= far; ++r0) {
      for (int c0 = -far; c0 <= far; ++c0) {
        CodePlacement p{c0, t.ca, t.cb, r0, t.ra, t.rb, out.read, 0};
        for (const CodedDot& d : dots) {
          if (d.bit < 0) continue;
          const GridIndex g = p.at(d);
          const bool is_on = g.col >= 0 && g.row >= 0 && g.col < target.cols && g.row < target.rows;
          p.wrong += !is_on || target.rings[static_cast<std::size_t>(target.index(g))] != d.bit ? 1 : 0;
          if (p.wrong >= out.next_wrong) break;
        }
        if (!out.best || p.wrong < out.best->wrong) {
          if (out.best) out.next_wrong = out.best->wrong;
          out.best = p;
        } else {
          out.next_wrong = std::min(out.next_wrong, p.wrong);
        }
      }
    }
  }
  if (out.best && out.read > 0) out.by_chance = 4.0 * target.size() * chance(out.read, out.best->wrong);
  return out;
}

/// The lattice with its axes as a design seen from in front has them: columns x rows against the image's u x v, since
/// the model's z faces the camera (dot_grid.cpp).
void make_right_handed(std::vector<LatticePoint>& lattice, const std::vector<Blob>& blobs) {
  Vector2d mean(0, 0), grid(0, 0), x(0, 0), y(0, 0);
  const double n = static_cast<double>(lattice.size());
  for (const LatticePoint& p : lattice) {
    mean += blobs[static_cast<std::size_t>(p.point)].ellipse.centre / n;
    grid += Vector2d(p.a, p.b) / n;
  }
  for (const LatticePoint& p : lattice) {
    const Vector2d d = blobs[static_cast<std::size_t>(p.point)].ellipse.centre - mean;
    x += (p.a - grid.x()) * d;
    y += (p.b - grid.y()) * d;
  }
  if (x.x() * y.y() - x.y() * y.x() < 0) return;
  for (LatticePoint& p : lattice) p.b = -p.b;
}

/// Drops spots that lie off the plane which all the others share.
void drop_strays(std::vector<GridDot>& dots, const TargetDesign& target) {
  std::vector<Vector2d> image, place;
  for (const GridDot& d : dots) {
    image.push_back(d.blob.centre);
    place.emplace_back(target.place(d.index).head<2>() / target.pitch_mm);
  }
  const auto to_place = fit_homography(image, place);
  if (!to_place) return;
  std::size_t i = 0;
  std::erase_if(dots, [&](const GridDot&) {
    const std::size_t k = i++;
    return !((map_point(*to_place, image[k]) - place[k]).norm() < kOnPlane);
  });
}

double least_distance(const std::vector<GridDot>& dots) {
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < dots.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) least = std::min(least, (dots[i].blob.centre - dots[j].blob.centre).norm());
  return least;
}

}  // namespace

Result<CodePlacement> place_on_map(const std::vector<CodedDot>& dots, const TargetDesign& target) {
  const Search seen = search(dots, target);
  if (seen.is_certain()) return *seen.best;
  std::vector<CodedDot> mirrored = dots;
  for (CodedDot& d : mirrored) d.b = -d.b;
  if (search(mirrored, target).is_certain())
    return fail(ErrorCode::kTargetMirrored, "the coded board's map fits only when it is mirrored");
  if (4.0 * target.size() * chance(seen.read, 0) >= kChance) {
    return fail(
        ErrorCode::kTargetNotFound,
        fmt::format("{} dots of the coded board can be read, too few to tell its place; show more of it", seen.read));
  }
  return fail(ErrorCode::kTargetNotFound,
              fmt::format("{} dots are in view, and the best of all places on the map of target.json contradicts {} of "
                          "them, the next one {}: this is another board, or half of its dots cannot be read",
                          seen.read, seen.best->wrong, std::min(seen.next_wrong, seen.read)));
}

Result<DotGrid> find_coded_grid(const Map<float>& image, const TargetDesign& target) {
  const std::vector<Blob> blobs = find_blobs(image, target.is_white_on_dark);
  std::vector<Vector2d> points;
  Vector2d middle(0, 0);
  for (const Blob& b : blobs) {
    points.push_back(b.ellipse.centre);
    middle += b.ellipse.centre / static_cast<double>(blobs.size());
  }
  if (blobs.empty()) return fail(ErrorCode::kTargetNotFound, "no round dots in view");
  std::vector<bool> taken(points.size(), false);
  std::vector<LatticePoint> lattice = grow_lattice(points, taken, middle);
  if (lattice.size() < 4) return fail(ErrorCode::kTargetNotFound, "the dots in view form no grid");
  for (const LatticePoint& p : lattice) taken[static_cast<std::size_t>(p.point)] = true;
  if (grow_lattice(points, taken, middle).size() >= kSecondLattice)
    return fail(ErrorCode::kTargetAmbiguous, "two grids of dots are in view");
  make_right_handed(lattice, blobs);
  std::vector<CodedDot> dots;
  for (const LatticePoint& p : lattice) {
    const Ellipse& e = blobs[static_cast<std::size_t>(p.point)].ellipse;
    dots.push_back({p.a, p.b, bit_of(image, e, target.ring_inner_mm / target.radius_mm)});
  }
  ENAMEL_TRY_ASSIGN(const CodePlacement placement, place_on_map(dots, target));
  DotGrid grid;
  for (std::size_t i = 0; i < dots.size(); ++i) {
    const GridIndex g = placement.at(dots[i]);
    if (g.col < 0 || g.row < 0 || g.col >= target.cols || g.row >= target.rows) continue;
    // A dot that reads otherwise than the map is stained or no dot: its centre is not to be trusted.
    if (dots[i].bit != target.rings[static_cast<std::size_t>(target.index(g))]) continue;
    grid.dots.push_back({target.index(g), blobs[static_cast<std::size_t>(lattice[i].point)].ellipse});
  }
  drop_strays(grid.dots, target);
  std::sort(grid.dots.begin(), grid.dots.end(), [](const GridDot& p, const GridDot& q) { return p.index < q.index; });
  grid.spacing_px = least_distance(grid.dots);
  return grid;
}

void fill_ring(Map<float>& image, const Ellipse& ring, double inner_share) {
  const double middle = 0.5 * (1 + inner_share), half = 0.2 * (1 - inner_share);
  const int reach = static_cast<int>(std::ceil(ring.half_axes().x())) + 1;
  const int cu = static_cast<int>(std::lround(ring.centre.x())), cv = static_cast<int>(std::lround(ring.centre.y()));
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  const auto visit = [&](auto&& use) {
    for (int v = cv - reach; v <= cv + reach; ++v)
      for (int u = cu - reach; u <= cu + reach; ++u)
        if (image.contains(u, v)) use(u, v, ring.radius_at({u, v}), Eigen::Vector3d(1, u - cu, v - cv));
  };
  visit([&](int u, int v, double radius, const Eigen::Vector3d& row) {
    if (std::abs(radius - middle) > half) return;
    normal += row * row.transpose();
    right += row * static_cast<double>(image(u, v));
  });
  if (!(normal.determinant() > 0)) return;
  const Eigen::Vector3d plane = normal.ldlt().solve(right);
  visit([&](int u, int v, double radius, const Eigen::Vector3d& row) {
    if (radius < middle) image(u, v) = static_cast<float>(plane.dot(row));
  });
}

}  // namespace enamel::calib
