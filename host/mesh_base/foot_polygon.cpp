#include "host/mesh_base/foot_polygon.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

namespace enamel::host {
namespace {

/// Twice the area of a triangle, positive when it runs counter-clockwise.
double turn(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// Of two segments that cross or touch; none of parallel ones, for a point moved by nothing uncrosses them.
std::optional<Vec2d> crossing(const Vec2d& a, const Vec2d& b, const Vec2d& c, const Vec2d& d) {
  if (std::max(a.x(), b.x()) < std::min(c.x(), d.x()) || std::max(c.x(), d.x()) < std::min(a.x(), b.x()) ||
      std::max(a.y(), b.y()) < std::min(c.y(), d.y()) || std::max(c.y(), d.y()) < std::min(a.y(), b.y()))
    return std::nullopt;
  const double from_c = turn(a, b, c), from_d = turn(a, b, d), from_a = turn(c, d, a), from_b = turn(c, d, b);
  if (from_c * from_d > 0 || from_a * from_b > 0 || from_c == from_d || from_a == from_b) return std::nullopt;
  return a + (b - a) * (from_a / (from_a - from_b));
}

/// A chain of the shadow's points that stand at one place.
struct Stand {
  Vec2d at;
  std::uint32_t first, count;  ///< of the shadow's points, counted round
};

double area_of(const std::vector<Stand>& ring, std::size_t from, std::size_t to, const Vec2d& closing) {
  double twice = 0;
  for (std::size_t k = from; k < to; ++k) {
    const Vec2d &a = ring[k].at, &b = k + 1 < to ? ring[k + 1].at : closing;
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return (twice + closing.x() * ring[from].at.y() - closing.y() * ring[from].at.x()) / 2;
}

std::uint32_t points_in(const std::vector<Stand>& ring, std::size_t from, std::size_t to) {
  std::uint32_t out = 0;
  for (std::size_t k = from; k < to; ++k) out += ring[k].count;
  return out;
}

/// Cuts the ring where the segments behind i and behind k cross. Returns where to look on.
std::size_t cut(std::vector<Stand>& ring, std::size_t i, std::size_t k, const Vec2d& at) {
  const auto after = [&](std::size_t n) { return ring.begin() + static_cast<std::ptrdiff_t>(n); };
  const double total = area_of(ring, 0, ring.size(), ring.front().at), inner = area_of(ring, i + 1, k + 1, at);
  if (inner <= total - inner) {
    ring[i + 1] = {at, ring[i + 1].first, points_in(ring, i + 1, k + 1)};
    ring.erase(after(i + 2), after(k + 1));
    return i;
  }
  std::vector<Stand> rest(after(i + 1), after(k + 1));
  rest.push_back(
      {at, ring[(k + 1) % ring.size()].first, points_in(ring, k + 1, ring.size()) + points_in(ring, 0, i + 1)});
  ring = std::move(rest);
  return 0;
}

/// One pass; whether anything was cut.
bool cut_first_crossing(std::vector<Stand>& ring, std::size_t& from) {
  for (std::size_t i = from; i + 2 < ring.size(); ++i) {
    for (std::size_t k = i + 2; k < ring.size(); ++k) {
      if (i == 0 && k + 1 == ring.size()) continue;  // neighbours
      const auto at = crossing(ring[i].at, ring[i + 1].at, ring[k].at, ring[(k + 1) % ring.size()].at);
      if (!at) continue;
      from = cut(ring, i, k, *at);
      return true;
    }
  }
  return false;
}

class EarCutter {
 public:
  explicit EarCutter(const std::vector<Vec2d>& polygon) : points_(polygon), ring_(polygon.size()) {
    std::iota(ring_.begin(), ring_.end(), 0U);
    for (std::size_t k = 0; k < ring_.size(); ++k) quality_.push_back(quality_at(k));
  }

  Ears cut() {
    Ears out;
    while (ring_.size() > 3) {
      const std::size_t k = best();
      const auto [a, b, c] = corners(k);
      out.triangles.push_back({a, b, c});
      if (!(turn(points_[a], points_[b], points_[c]) > 0)) ++out.folded;
      remove(k);
    }
    if (ring_.size() == 3) out.triangles.push_back({ring_[0], ring_[1], ring_[2]});
    return out;
  }

 private:
  [[nodiscard]] Triangle corners(std::size_t k) const {
    const std::size_t n = ring_.size();
    return {ring_[(k + n - 1) % n], ring_[k], ring_[(k + 1) % n]};
  }

  /// Area against the longest side squared; not above 0: no ear.
  [[nodiscard]] double quality_at(std::size_t k) const {
    const auto [a, b, c] = corners(k);
    const Vec2d &p = points_[a], &q = points_[b], &r = points_[c];
    const double longest2 = std::max({(q - p).squaredNorm(), (r - q).squaredNorm(), (p - r).squaredNorm()});
    return longest2 > 0 ? turn(p, q, r) / longest2 : 0;
  }

  [[nodiscard]] bool blocked(std::size_t k) const {
    const auto [ia, ib, ic] = corners(k);
    const Vec2d &a = points_[ia], &b = points_[ib], &c = points_[ic];
    for (const std::uint32_t v : ring_) {
      const Vec2d& p = points_[v];
      if (v == ia || v == ib || v == ic || p == a || p == b || p == c) continue;
      if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return true;
    }
    return false;
  }

  /// The best shaped corner that nothing lies in; of a polygon that is not simple, the best shaped one.
  std::size_t best() {
    constexpr double kTried = -std::numeric_limits<double>::infinity();
    std::vector<double> left = quality_;
    for (;;) {
      const auto at = std::ranges::max_element(left);
      const auto k = static_cast<std::size_t>(at - left.begin());
      if (!(*at > 0)) return static_cast<std::size_t>(std::ranges::max_element(quality_) - quality_.begin());
      if (!blocked(k)) return k;
      *at = kTried;
    }
  }

  void remove(std::size_t k) {
    ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(k));
    quality_.erase(quality_.begin() + static_cast<std::ptrdiff_t>(k));
    const std::size_t n = ring_.size();
    for (const std::size_t at : {(k + n - 1) % n, k % n}) quality_[at] = quality_at(at);
  }

  const std::vector<Vec2d>& points_;
  std::vector<std::uint32_t> ring_;
  std::vector<double> quality_;
};

}  // namespace

double signed_area(const std::vector<Vec2d>& polygon) {
  double twice = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2d &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

FootPolygon uncrossed(const std::vector<Vec2d>& shadow) {
  FootPolygon out;
  std::vector<Stand> ring;
  for (std::uint32_t k = 0; k < shadow.size(); ++k) ring.push_back({shadow[k], k, 1});
  std::size_t from = 0;
  while (ring.size() > 3 && cut_first_crossing(ring, from)) ++out.crossings;  // every cut takes a point away
  out.of.resize(shadow.size());
  for (std::uint32_t s = 0; s < ring.size(); ++s) {
    out.points.push_back(ring[s].at);
    for (std::uint32_t k = 0; k < ring[s].count; ++k) out.of[(ring[s].first + k) % shadow.size()] = s;
  }
  if (signed_area(out.points) <= 0) out.points.clear();
  return out;
}

Ears cut_ears(const std::vector<Vec2d>& polygon) { return EarCutter(polygon).cut(); }

}  // namespace enamel::host
