#include "tests/support/order_score.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace enamel::test {
namespace {

/// Absolute phase from the wrapped one and the number of its fringe.
double absolute_phase(double phase_rad, int order) {
  return phase_rad + 2 * std::numbers::pi * (order + (phase_rad < 0 ? 1 : 0));
}

bool is_masked(pipeline::PixelReject r) {
  return r == pipeline::PixelReject::kDark || r == pipeline::PixelReject::kSaturated ||
         r == pipeline::PixelReject::kNoisy;
}

}  // namespace

OrderCounts& OrderCounts::operator+=(const OrderCounts& o) {
  bursts += o.bursts, rejected_bursts += o.rejected_bursts, bursts_with_large_wrong += o.bursts_with_large_wrong;
  lit += o.lit, masked += o.masked, edge += o.edge, undecided += o.undecided, accepted += o.accepted, wrong += o.wrong;
  band_accepted += o.band_accepted, band_wrong += o.band_wrong;
  largest_wrong_px = std::max(largest_wrong_px, o.largest_wrong_px);
  squares_mm2 += o.squares_mm2, sigma_mm2 += o.sigma_mm2;
  return *this;
}

double OrderCounts::rms_um() const {
  return accepted > wrong ? 1e3 * std::sqrt(squares_mm2 / static_cast<double>(accepted - wrong)) : 0;
}

double OrderCounts::sigma_um() const {
  return accepted > wrong ? 1e3 * std::sqrt(sigma_mm2 / static_cast<double>(accepted - wrong)) : 0;
}

std::size_t largest_region(const Map<std::uint8_t>& marked) {
  Map<std::uint8_t> left = marked;
  std::vector<std::size_t> queue;
  const auto width = static_cast<std::size_t>(marked.width());
  std::size_t largest = 0;
  const auto take = [&](std::size_t i) {
    if (left[i] == 0) return;
    left[i] = 0;
    queue.push_back(i);
  };
  for (std::size_t seed = 0; seed < left.size(); ++seed) {
    queue.clear();
    take(seed);
    std::size_t taken = 0;
    while (taken < queue.size()) {  // it grows as its pixels find their neighbours
      const std::size_t i = queue[taken++];
      if (i % width > 0) take(i - 1);
      if ((i + 1) % width > 0) take(i + 1);
      if (i >= width) take(i - width);
      if (i + width < left.size()) take(i + width);
    }
    largest = std::max(largest, queue.size());
  }
  return largest;
}

OrderCounts score_orders(const pipeline::DecodedBurst& burst, const SyntheticBurst& truth, const Map<double>& light,
                         const Map<std::uint8_t>& band) {
  OrderCounts out;
  out.bursts = 1;
  out.rejected_bursts = burst.accepted() ? 0 : 1;
  Map<std::uint8_t> wrong(light.width(), light.height());
  for (std::size_t i = 0; i < light.size(); ++i) {
    if (!(light[i] > 0)) continue;
    ++out.lit;
    const pipeline::PixelReject why = burst.reject[i];
    if (is_masked(why)) {
      ++out.masked;
    } else if (burst.accepted() && why == pipeline::PixelReject::kEdge) {
      ++out.edge;
    } else if (!burst.accepted() || why != pipeline::PixelReject::kNone) {
      ++out.undecided;
    } else {
      const double phi = absolute_phase(static_cast<double>(burst.phase_rad[i]), burst.order[i]);
      wrong[i] = std::abs(phi - truth.phase_rad[i]) > std::numbers::pi ? 1 : 0;
      ++out.accepted;
      out.wrong += wrong[i];
      out.band_accepted += band[i];
      out.band_wrong += band[i] != 0 ? wrong[i] : 0U;
      if (wrong[i] != 0) continue;
      const double e = static_cast<double>(burst.patch.depth_mm[i]) - truth.depth_mm[i];
      const auto sigma = static_cast<double>(burst.patch.sigma_mm[i]);
      out.squares_mm2 += e * e, out.sigma_mm2 += sigma * sigma;
    }
  }
  out.largest_wrong_px = largest_region(wrong);
  out.bursts_with_large_wrong = out.largest_wrong_px > kLargeWrong_px ? 1 : 0;
  return out;
}

}  // namespace enamel::test
