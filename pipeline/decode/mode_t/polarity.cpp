#include "pipeline/decode/mode_t/polarity.hpp"

#include <algorithm>
#include <vector>

#include "pipeline/decode/mode_t/polarity_rows.hpp"

namespace enamel::pipeline {
namespace {

/// Storage of a PolarityRow, filled span by span from left to right. A span is filled in steps that may run beyond its
/// end, where the next span or what closes the gap before it comes to lie: spans are short, and steps of a fixed length
/// are single stores.
class RowState {
 public:
  explicit RowState(std::size_t width) : cell_(width + kStep), wraps_(width + kStep) {}

  /// The row has no pixel before `begin`.
  void start(std::int32_t begin) { filled_ = begin; }

  void add(const CellSpan& s, const CellSigns& signs) {
    const float b = signs.at(s.cell);
    const int bits = (b < 0 ? kMinus : 0) | (signs.at(s.cell - 1) * b < 0 ? kLowFlip : 0) |
                     (signs.at(s.cell + 1) * b < 0 ? kHighFlip : 0) | ((s.cell & 1) != 0 ? kUpperHalf : 0);
    fill(filled_, s.begin, kOutside, 0);
    fill(s.begin, s.end, bits, wraps_of_cell(s.cell));
    filled_ = s.end;
  }

  [[nodiscard]] PolarityRow row() const { return {cell_.data(), wraps_.data()}; }

 private:
  static constexpr std::int32_t kStep = 16;  ///< layout: a store

  void fill(std::int32_t begin, std::int32_t end, int bits, int wraps) {
    for (std::int32_t u = begin; u < end; u += kStep) {
      std::fill_n(cell_.begin() + u, kStep, static_cast<std::uint8_t>(bits));
      std::fill_n(wraps_.begin() + u, kStep, static_cast<std::int16_t>(wraps));
    }
  }

  std::int32_t filled_ = 0;
  std::vector<std::uint8_t> cell_;
  std::vector<std::int16_t> wraps_;
};

}  // namespace

void apply_polarity(std::span<const CellSpan> spans, const CellSigns& signs, const NoiseModel& noise,
                    const PolarityConfig& config, PhaseMaps& maps, PolarityMaps& out) {
  const int w = maps.phase_rad.width(), h = maps.phase_rad.height();
  if (out.weight.width() != w || out.weight.height() != h) {
    out.weight = Map<float>(w, h);
    out.wraps = Map<std::int16_t>(w, h);
  }
  RowState state(static_cast<std::size_t>(w));
  auto next = spans.begin();
  for (int v = 0; v < h; ++v) {
    float* weight = &out.weight(0, v);
    const bool any = next != spans.end() && next->row == v;
    const std::int32_t begin = any ? next->begin : w;
    std::int32_t end = begin;
    state.start(begin);
    for (; next != spans.end() && next->row == v; ++next) {
      state.add(*next, signs);
      end = next->end;
    }
    std::fill(weight, weight + begin, 0.0F);
    std::fill(weight + end, weight + w, 0.0F);
    if (any) {
      solve_polarity_row(state.row(), out.weight.index(0, v), static_cast<std::size_t>(begin),
                         static_cast<std::size_t>(end), noise, config, maps, out);
    }
  }
}

}  // namespace enamel::pipeline
