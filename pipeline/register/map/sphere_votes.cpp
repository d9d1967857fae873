#include "pipeline/register/map/sphere_votes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace enamel::pipeline {
namespace {

using Key = std::int64_t;
constexpr Key kRow = 1 << 20;  // cells a row: none holds so many

Key key_of(const Vec3f& p, float cell) {
  const auto at = [&](int k) { return static_cast<Key>(std::floor(p[k] / cell)); };
  return (at(2) * kRow + at(1)) * kRow + at(0);
}

/// Cells in ascending order of key, with the votes in them.
class Cells {
 public:
  Cells(const std::vector<Vec3f>& votes, float cell) {
    std::vector<Key> keys;
    keys.reserve(votes.size());
    for (const Vec3f& p : votes) keys.push_back(key_of(p, cell));
    std::ranges::sort(keys);
    for (const Key key : keys) {
      if (cells_.empty() || cells_.back().first != key) cells_.emplace_back(key, 0);
      ++cells_.back().second;
    }
  }
  [[nodiscard]] const std::vector<std::pair<Key, int>>& all() const { return cells_; }
  /// Of the cell and its 26 neighbours.
  [[nodiscard]] int around(Key key) const {
    int sum = 0;
    for (Key z = -1; z <= 1; ++z) {
      for (Key y = -1; y <= 1; ++y) sum += row(key + (z * kRow + y) * kRow);
    }
    return sum;
  }

 private:
  [[nodiscard]] int row(Key middle) const {
    int sum = 0;
    auto at = std::ranges::lower_bound(cells_, middle - 1, {}, &std::pair<Key, int>::first);
    for (; at != cells_.end() && at->first <= middle + 1; ++at) sum += at->second;
    return sum;
  }
  std::vector<std::pair<Key, int>> cells_;
};

Vec3f centre_of(Key key, float cell) {
  const auto split = [](Key v) {  // last place, balanced, and the rest
    Key low = v % kRow;
    if (low < 0) low += kRow;
    if (low >= kRow / 2) low -= kRow;
    return std::pair<Key, Key>{low, (v - low) / kRow};
  };
  const auto [x, rest] = split(key);
  const auto [y, z] = split(rest);
  return cell * Vec3f(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F, static_cast<float>(z) + 0.5F);
}

VotePeak climb(const std::vector<Vec3f>& votes, VotePeak peak, float reach) {
  constexpr int kSteps = 4;
  for (int step = 0; step < kSteps; ++step) {
    Vec3d sum = Vec3d::Zero();
    int count = 0;
    for (const Vec3f& p : votes) {
      if ((p - peak.at).squaredNorm() > reach * reach) continue;
      sum += p.cast<double>();
      ++count;
    }
    peak.votes = count;
    if (count == 0) break;
    peak.at = (sum / count).cast<float>();
  }
  return peak;
}

}  // namespace

std::vector<VotePeak> find_peaks(const std::vector<Vec3f>& votes, float reach_mm, float apart_mm, int min_votes) {
  const Cells cells(votes, reach_mm);
  std::vector<std::pair<int, Key>> crowded;  // a ball of that reach about a peak lies within 27 cells
  for (const auto& [key, count] : cells.all()) {
    constexpr int kOfItself = 27;  // a crowd's cell holds more than its share of the crowd
    const int around = cells.around(key);
    if (around >= min_votes && count * kOfItself >= around) crowded.emplace_back(-around, key);
  }
  std::ranges::sort(crowded);
  constexpr std::size_t kMost = 200;  // seeds; a picture with more is no picture of balls
  if (crowded.size() > kMost) crowded.resize(kMost);
  std::vector<VotePeak> out;
  const auto is_near = [&](const Vec3f& at, float distance) {
    return std::ranges::any_of(out, [&](const VotePeak& p) { return (p.at - at).norm() < distance; });
  };
  for (const auto& [negative, key] : crowded) {
    const Vec3f start = centre_of(key, reach_mm);
    if (is_near(start, 2 * reach_mm)) continue;
    const VotePeak peak = climb(votes, {start, 0}, reach_mm);
    if (peak.votes >= min_votes && !is_near(peak.at, apart_mm)) out.push_back(peak);
  }
  std::ranges::stable_sort(out, std::ranges::greater{}, &VotePeak::votes);
  return out;
}

}  // namespace enamel::pipeline
