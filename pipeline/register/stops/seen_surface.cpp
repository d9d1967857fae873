#include "pipeline/register/stops/seen_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace enamel::pipeline {
namespace {

constexpr int kDirections = 8;
constexpr std::uint32_t kFewestPoints = 2;  // of a cell that is asked for its rim: one point may be an outlier
constexpr float kRimCells = 2;              // how far off a neighbour is looked for
constexpr float kEndWeight = 0.4F;          // chosen: of a guess at the end of its reach

using Place = std::array<std::int64_t, 3>;

Place place_of(const Vec3f& p, double cell_mm) {
  const auto at = [&](int k) { return static_cast<std::int64_t>(std::floor(static_cast<double>(p[k]) / cell_mm)); };
  return {at(0), at(1), at(2)};
}

/// 21 bits an axis: a kilometre of cells, so that places never meet.
std::uint64_t key_of(const Place& p) {
  constexpr std::int64_t kHalf = std::int64_t{1} << 20U;
  std::uint64_t key = 0;
  for (const std::int64_t x : p) key = (key << 21U) | (static_cast<std::uint64_t>(x + kHalf) & 0x1FFFFFU);
  return key;
}

/// Cells that a plane passes an area: |n|_1 / edge^2.
float area_of(const Vec3f& normal, double cell_mm) {
  return static_cast<float>(cell_mm * cell_mm) / std::max(normal.lpNorm<1>(), 1.0F);
}

Vec3f tangent(const Vec3f& normal, int n) {
  const Vec3f u = normal.unitOrthogonal(), v = normal.cross(u);
  const float angle = static_cast<float>(2 * std::numbers::pi * n / kDirections);
  return std::cos(angle) * u + std::sin(angle) * v;
}

}  // namespace

SeenSurface::SeenSurface(double cell_mm, double reach_mm)
    : cell_mm_(cell_mm), steps_(std::max(1, static_cast<int>(std::floor(reach_mm / (2 * cell_mm))))) {}

void SeenSurface::add(const std::vector<SeenPoint>& points) {
  const std::size_t first_new = cells_.size();
  std::vector<std::uint32_t> touched;
  for (const SeenPoint& p : points) {
    const auto [it, is_new] =
        at_.try_emplace(key_of(place_of(p.point, cell_mm_)), static_cast<std::uint32_t>(cells_.size()));
    if (is_new) {
      cells_.emplace_back();
      sums_.emplace_back();
    }
    Sums& s = sums_[it->second];
    if (s.stop_points == 0) touched.push_back(it->second);
    s.point += p.point;
    s.normal += p.normal;
    s.stop_cosine += p.cosine;
    ++s.points;
    ++s.stop_points;
  }
  for (const std::uint32_t cell : touched) close_stop(cell);
  find_rim(first_new);
}

void SeenSurface::close_stop(std::uint32_t cell) {
  Sums& s = sums_[cell];
  SeenCell& c = cells_[cell];
  const auto count = static_cast<float>(s.points);
  c.point = s.point / count;
  c.normal = s.normal.normalized();
  c.area_mm2 = area_of(c.normal, cell_mm_);
  c.cosine = std::max(c.cosine, s.stop_cosine / static_cast<float>(s.stop_points));
  s.stop_cosine = 0;
  s.stop_points = 0;
}

/// A cell that is no rim never becomes one: what was seen stays seen.
void SeenSurface::find_rim(std::size_t first_new) {
  std::vector<std::uint32_t> asked;
  for (const Rim& r : rim_) asked.push_back(r.cell);
  for (std::size_t n = first_new; n < cells_.size(); ++n) asked.push_back(static_cast<std::uint32_t>(n));
  rim_.clear();
  for (const std::uint32_t n : asked) {
    const bool is_sure = sums_[n].points >= kFewestPoints;
    const std::uint8_t open = is_sure ? open_directions(cells_[n]) : std::uint8_t{0xFF};
    if (open != 0) rim_.push_back({n, is_sure ? open : std::uint8_t{0}});
  }
}

std::uint8_t SeenSurface::open_directions(const SeenCell& cell) const {
  unsigned open = 0;
  for (int n = 0; n < kDirections; ++n) {
    const Vec3f p = cell.point + kRimCells * static_cast<float>(cell_mm_) * tangent(cell.normal, n);
    if (!is_near_seen(p)) open |= 1U << static_cast<unsigned>(n);
  }
  return static_cast<std::uint8_t>(open);
}

bool SeenSurface::is_near_seen(const Vec3f& point) const {
  const Place at = place_of(point, cell_mm_);
  for (std::int64_t z = -1; z <= 1; ++z) {
    for (std::int64_t y = -1; y <= 1; ++y) {
      for (std::int64_t x = -1; x <= 1; ++x) {
        if (at_.contains(key_of({at[0] + x, at[1] + y, at[2] + z}))) return true;
      }
    }
  }
  return false;
}

void SeenSurface::begin_guess() {
  expected_.clear();
  expected_at_.clear();
  guess_rim_ = 0;
  guess_direction_ = guess_step_ = 0;
}

/// Along every open direction until it meets what was seen.
std::optional<ExpectedCell> SeenSurface::next_guess() {
  while (guess_rim_ < rim_.size()) {
    const Rim& r = rim_[guess_rim_];
    const bool is_open = (r.open >> static_cast<unsigned>(guess_direction_)) & 1U;
    if (is_open && guess_step_ < steps_) {
      const SeenCell& c = cells_[r.cell];
      const auto away = static_cast<float>((++guess_step_) * 2 * cell_mm_);
      ExpectedCell out;
      out.point = c.point + away * tangent(c.normal, guess_direction_);
      out.normal = c.normal;
      out.weight = 1 - (1 - kEndWeight) * static_cast<float>(guess_step_ - 1) / static_cast<float>(steps_);
      out.key = key_of(place_of(out.point, 2 * cell_mm_));
      if (!is_near_seen(out.point)) return out;
    }
    guess_step_ = 0;
    if (++guess_direction_ == kDirections) {
      guess_direction_ = 0;
      ++guess_rim_;
    }
  }
  return std::nullopt;
}

void SeenSurface::keep(const ExpectedCell& guess) {
  const auto vain = vain_.find(guess.key);
  ExpectedCell out = guess;
  if (vain != vain_.end()) out.weight = std::ldexp(out.weight, -static_cast<int>(vain->second));
  const auto [it, is_new] = expected_at_.try_emplace(guess.key, static_cast<std::uint32_t>(expected_.size()));
  if (is_new) {
    expected_.push_back(out);
  } else if (out.weight > expected_[it->second].weight) {
    expected_[it->second] = out;
  }
}

double SeenSurface::area_mm2(double least_cosine) const {
  double sum = 0;
  for (const SeenCell& c : cells_) {
    if (static_cast<double>(c.cosine) >= least_cosine) sum += static_cast<double>(c.area_mm2);
  }
  return sum;
}

}  // namespace enamel::pipeline
