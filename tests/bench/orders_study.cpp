// Wrong orders over many random rows of teeth: the code of modes T and M, and the single marker beside them.
#include <algorithm>
#include <future>
#include <thread>
#include <vector>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/bench/study.hpp"
#include "tests/support/marker_baseline.hpp"
#include "tests/support/order_score.hpp"
#include "tests/support/tooth_steps.hpp"

namespace enamel::bench {
namespace {

constexpr int kWidth = 400, kHeight = 300;
constexpr int kEvery = 10;  ///< bursts of the codes for one of the marker

test::SyntheticBurst render(const calib::Rig& rig, const test::ToothSteps& steps, std::uint64_t seed) {
  return test::render(
      rig, [&steps](int u, int v) { return steps.depth_mm(u, v); }, steps.options(seed));
}

/// The baseline's orders in the form of a decoded burst: what it does not place is undecided.
test::OrderCounts score_marker(const calib::Rig& rig, const pipeline::RayDepth& rays, const test::ToothSteps& steps,
                               const pipeline::DecodedBurst& by_code, std::uint64_t seed) {
  const auto burst = render(rig, steps, seed);
  const test::MarkerOrders orders = test::orders_from_marker(rig, rays, burst.frames.view());
  pipeline::DecodedBurst as_decoded = by_code;  // same mask, same noise
  as_decoded.verdict = pipeline::BurstVerdict::kAccepted;
  as_decoded.phase_rad = orders.phase_rad;
  for (std::size_t i = 0; i < orders.order.size(); ++i) {
    pipeline::PixelReject& why = as_decoded.reject[i];
    const bool left_out = why == pipeline::PixelReject::kDark || why == pipeline::PixelReject::kSaturated ||
                          why == pipeline::PixelReject::kNoisy || why == pipeline::PixelReject::kEdge;
    if (!left_out) why = orders.order[i] < 0 ? pipeline::PixelReject::kRelative : pipeline::PixelReject::kNone;
    as_decoded.order[i] = static_cast<std::uint8_t>(std::max(0, orders.order[i]));
  }
  return test::score_orders(as_decoded, burst, steps.light, steps.near_jump);
}

Json counts_json(const test::OrderCounts& c) {
  return {{"bursts", c.bursts},
          {"rejected_bursts", c.rejected_bursts},
          {"wrong_pct", c.wrong_pct()},
          {"band_wrong_pct", c.band_wrong_pct()},
          {"undecided_pct", c.undecided_pct()},
          {"edge_pct", c.edge_pct()},
          {"masked_pct", c.masked_pct()},
          {"accepted_px", c.accepted},
          {"largest_wrong_px", c.largest_wrong_px},
          {"bursts_with_large_wrong", c.bursts_with_large_wrong}};
}

/// Counts of some of the bursts.
struct Counts {
  test::OrderCounts t, m, marker;

  Counts& operator+=(const Counts& o) {
    t += o.t, m += o.m, marker += o.marker;
    return *this;
  }
};

/// Bursts first, first + step ... below `end`.
Counts count_orders(int first, int step, int end) {
  const calib::Rig t = test::cropped_rig(kWidth, kHeight), m = test::micro_rig(kWidth, kHeight, test::kShippedRatio);
  calib::Rig marked = t;
  marked.patterns.mode = calib::PatternMode::kSingle;
  marked.patterns.polarity_code.clear();
  marked.patterns.marker_fringe = 17;  // in the middle of the field, half way through the depth range
  const auto by_t = pipeline::BurstDecoder::make(t).value(), by_m = pipeline::BurstDecoder::make(m).value();
  pipeline::DecodeWorkspace workspace;
  pipeline::DecodedBurst decoded;
  Counts out;
  for (int k = first; k < end; k += step) {
    const auto seed = static_cast<std::uint64_t>(1000 + k);
    const test::ToothSteps steps = test::make_tooth_steps(t, seed);
    const auto burst = render(t, steps, seed);
    by_t.decode(burst.frames.view(), workspace, decoded);
    out.t += test::score_orders(decoded, burst, steps.light, steps.near_jump);
    if (k % kEvery == 0) out.marker += score_marker(marked, by_t.rays(), steps, decoded, seed);
    const auto other = render(m, steps, seed);
    by_m.decode(other.frames.view(), workspace, decoded);
    out.m += test::score_orders(decoded, other, steps.light, steps.near_jump);
  }
  return out;
}

}  // namespace

Json orders_study(int bursts) {
  const int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::vector<std::future<Counts>> parts;
  parts.reserve(static_cast<std::size_t>(threads));
  for (int k = 0; k < threads; ++k) parts.push_back(std::async(std::launch::async, count_orders, k, threads, bursts));
  Counts all;
  for (auto& part : parts) all += part.get();
  return {{"T", counts_json(all.t)}, {"M", counts_json(all.m)}, {"marker", counts_json(all.marker)}};
}

}  // namespace enamel::bench
