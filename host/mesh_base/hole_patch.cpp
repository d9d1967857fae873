#include "host/mesh_base/hole_patch.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

namespace enamel::host {
namespace {

constexpr std::size_t kMostAtOnce = 120;  ///< chosen: cubic in it; 0.1 s
/// Of the longest edge squared: less is no area to readers of mesh files, and a needle to everybody.
constexpr double kNoArea = 1e-9;
constexpr double kNever = std::numeric_limits<double>::infinity();

class SmallestSurface {
 public:
  SmallestSurface(const Loop& loop, const std::vector<Vec3f>& vertices, const Joined& joined)
      : loop_(loop),
        vertices_(vertices),
        joined_(joined),
        n_(loop.size()),
        cost_(n_ * n_, kNever),
        middle_(n_ * n_, 0) {}

  std::optional<std::vector<Triangle>> find() {
    for (std::size_t i = 0; i + 1 < n_; ++i) cost_[i * n_ + i + 1] = 0;
    for (std::size_t span = 2; span < n_; ++span)
      for (std::size_t i = 0; i + span < n_; ++i) settle(i, i + span);
    if (cost_[n_ - 1] == kNever) return std::nullopt;
    std::vector<Triangle> out;
    collect(0, n_ - 1, out);
    return out;
  }

 private:
  [[nodiscard]] double area(std::size_t i, std::size_t m, std::size_t k) const {
    const Vec3d a = at(i), b = at(m), c = at(k);
    const double area = (b - a).cross(c - a).norm();
    const double longest2 = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    return area > kNoArea * longest2 ? area : kNever;
  }
  [[nodiscard]] Vec3d at(std::size_t i) const { return vertices_[loop_[i]].cast<double>(); }

  void settle(std::size_t i, std::size_t k) {
    if (!(i == 0 && k == n_ - 1) && joined_(loop_[i], loop_[k])) return;
    double& best = cost_[i * n_ + k];
    for (std::size_t m = i + 1; m < k; ++m) {
      const double sides = cost_[i * n_ + m] + cost_[m * n_ + k];
      if (sides >= best) continue;
      const double cost = sides + area(i, m, k);
      if (cost >= best) continue;
      best = cost;
      middle_[i * n_ + k] = m;
    }
  }

  void collect(std::size_t i, std::size_t k, std::vector<Triangle>& out) const {
    if (k < i + 2) return;
    const std::size_t m = middle_[i * n_ + k];
    out.push_back({loop_[k], loop_[m], loop_[i]});
    collect(i, m, out);
    collect(m, k, out);
  }

  const Loop& loop_;
  const std::vector<Vec3f>& vertices_;
  const Joined& joined_;
  std::size_t n_;
  std::vector<double> cost_;
  std::vector<std::size_t> middle_;
};

/// The chord that is shortest against the way round between its ends; both sides keep a quarter and more.
std::optional<std::pair<std::size_t, std::size_t>> best_chord(const Loop& loop, const std::vector<Vec3f>& vertices,
                                                              const Joined& joined) {
  const std::size_t n = loop.size(), least = n / 4;
  std::optional<std::pair<std::size_t, std::size_t>> best;
  float shortest = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = i + least; k < n && n - (k - i) >= least; ++k) {
      const float length2 = (vertices[loop[i]] - vertices[loop[k]]).squaredNorm();
      if (length2 >= shortest || joined(loop[i], loop[k])) continue;
      shortest = length2;
      best = {i, k};
    }
  }
  return best;
}

std::vector<Triangle> round_middle(const Loop& loop, std::vector<Vec3f>& vertices) {
  Vec3d sum = Vec3d::Zero();
  for (const std::uint32_t v : loop) sum += vertices[v].cast<double>();
  const auto middle = static_cast<std::uint32_t>(vertices.size());
  vertices.push_back((sum / static_cast<double>(loop.size())).cast<float>());
  std::vector<Triangle> out;
  for (std::size_t i = 0; i < loop.size(); ++i) out.push_back({loop[(i + 1) % loop.size()], loop[i], middle});
  return out;
}

}  // namespace

std::vector<Triangle> close_hole(const Loop& loop, std::vector<Vec3f>& vertices, const Joined& joined) {
  if (loop.size() > kMostAtOnce) {
    if (const auto chord = best_chord(loop, vertices, joined)) {
      const auto from = loop.begin() + static_cast<std::ptrdiff_t>(chord->first);
      const auto to = loop.begin() + static_cast<std::ptrdiff_t>(chord->second);
      const Loop inner(from, to + 1);
      Loop outer(loop.begin(), from + 1);
      outer.insert(outer.end(), to, loop.end());
      std::vector<Triangle> out = close_hole(inner, vertices, joined);
      const std::vector<Triangle> rest = close_hole(outer, vertices, joined);
      out.insert(out.end(), rest.begin(), rest.end());
      return out;
    }
    return round_middle(loop, vertices);
  }
  auto out = SmallestSurface(loop, vertices, joined).find();
  return out ? std::move(*out) : round_middle(loop, vertices);
}

}  // namespace enamel::host
