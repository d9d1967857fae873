#include "pipeline/decode/unwrap/cut_costs.hpp"

#include <algorithm>
#include <array>

#include "pipeline/decode/unwrap/byte_runs.hpp"
#include "pipeline/decode/unwrap/cut_rows.hpp"

namespace enamel::pipeline {
namespace {

void resize(int width, int height, CutCosts& out) {
  const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
  if (out.stride == w + 2 && out.rows == h + 2) return;  // margins stay 0: only the image is written
  out.stride = w + 2, out.rows = h + 2;
  const std::size_t n = out.stride * out.rows;
  out.valid.assign(n, 0);
  out.valid.resize(n + kRunPadding, 255);
  out.east_turn.assign(n, 0), out.south_turn.assign(n, 0);
  out.east_cost.assign(n, 0), out.south_cost.assign(n, 0);
}

/// Differences to the row below, of three successive rows.
class SouthRows {
 public:
  SouthRows(float* memory, std::size_t width) : rows_{memory, memory + width, memory + 2 * width}, width_(width) {
    std::fill_n(memory, 3 * width, kInvalidDifference);
  }
  float* next() {
    std::rotate(rows_.begin(), rows_.begin() + 1, rows_.end());
    return rows_[2];
  }
  void none() { std::fill_n(next(), width_, kInvalidDifference); }
  [[nodiscard]] LineOfDifferences line() const { return {rows_[0], rows_[1], rows_[2]}; }

 private:
  std::array<float*, 3> rows_;
  std::size_t width_;
};

/// A pixel of too much noise for depth, or beside an edge, still has a phase and a sigma: for a cut it is no hole to
/// slip through.
void bridge_noise(const Map<PixelReject>& reject, Map<PixelReject>& out) {
  if (out.width() != reject.width() || out.height() != reject.height())
    out = Map<PixelReject>(reject.width(), reject.height());
  std::transform(reject.pixels().begin(), reject.pixels().end(), out.pixels().begin(), [](PixelReject r) {
    return r == PixelReject::kNoisy || r == PixelReject::kEdge ? PixelReject::kNone : r;
  });
}

}  // namespace

void measure_cut_costs(const PhaseMaps& phase, const Carrier& carrier, const CutConfig& config, CutCosts& out) {
  const int w = phase.phase_rad.width(), h = phase.phase_rad.height();
  const auto width = static_cast<std::size_t>(w);
  resize(w, h, out);
  out.scratch.assign(width + 2 + 3 * width, kInvalidDifference);
  float* east = out.scratch.data() + 1;  // one invalid link before the first pixel and one behind the last
  SouthRows south(east + width + 1, width);
  bridge_noise(phase.reject, out.reject);
  const auto row_of = [&](int v) {
    const std::size_t at = static_cast<std::size_t>(v) * width;
    return PixelRow{&phase.phase_rad[at], &phase.sigma_rad[at], carrier.phase_mid_rad + at, &out.reject[at]};
  };
  for (int v = 0; v < h; ++v) {
    const std::size_t to = static_cast<std::size_t>(v + 1) * out.stride + 1;
    const PixelRow row = row_of(v);
    for (std::size_t u = 0; u < width; ++u) out.valid[to + u] = row.reject[u] == PixelReject::kNone ? 1 : 0;
    difference_row(row, 1, width - 1, east);
    cut_cost_row(row, 1, width - 1, {east - 1, east, east + 1}, carrier.slope_u_rad, config, &out.east_cost[to]);
    wrap_row(row, 1, width - 1, east, &out.east_turn[to]);
    if (v + 1 < h) {
      float* below = south.next();
      difference_row(row, w, width, below);
      wrap_row(row, w, width, below, &out.south_turn[to]);
    } else {
      south.none();
    }
    // Of the row before, whose next links are known by now.
    if (v == 0) continue;
    cut_cost_row(row_of(v - 1), w, width, south.line(), carrier.slope_v_rad, config, &out.south_cost[to - out.stride]);
  }
}

}  // namespace enamel::pipeline
