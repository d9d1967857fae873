#include "pipeline/algo/phase/polarity.hpp"

#include <algorithm>
#include <type_traits>
#include <vector>

#include "pipeline/algo/phase/polarity_rows.hpp"
#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

/// Storage of a PolarityRow, filled span by span.
class RowState {
 public:
  explicit RowState(std::size_t width)
      : sign_(width), low_flip_(width), high_flip_(width), origin_(width), turn_(width) {}

  /// Between spans frame 3 counts as useless, which leaves those pixels as they are.
  void clear() {
    constexpr float kUseless = -100;
    std::fill(sign_.begin(), sign_.end(), 1.0F);
    for (auto* flip : {&low_flip_, &high_flip_}) std::fill(flip->begin(), flip->end(), kUseless);
    std::fill(origin_.begin(), origin_.end(), 0.0F);
    std::fill(turn_.begin(), turn_.end(), std::int16_t{0});
  }

  void add(const CellSpan& s, const CellSigns& signs) {
    constexpr float kFar = 10;
    const float b = signs.at(s.cell);
    const auto put = [&](auto& row, auto value) {
      std::fill(row.begin() + s.begin, row.begin() + s.end, static_cast<std::decay_t<decltype(row[0])>>(value));
    };
    put(sign_, b);
    put(low_flip_, signs.at(s.cell - 1) * b > 0 ? kFar : 0);
    put(high_flip_, signs.at(s.cell + 1) * b > 0 ? kFar : 0);
    put(origin_, (s.cell & 1) != 0 ? -kPiF : 0);
    put(turn_, turn_of_cell(s.cell));
  }

  [[nodiscard]] PolarityRow row() const {
    return {sign_.data(), low_flip_.data(), high_flip_.data(), origin_.data(), turn_.data()};
  }

 private:
  std::vector<float> sign_, low_flip_, high_flip_, origin_;
  std::vector<std::int16_t> turn_;
};

}  // namespace

void apply_polarity(std::span<const CellSpan> spans, const CellSigns& signs, const NoiseModel& noise,
                    const PolarityConfig& config, PhaseMaps& maps, PolarityMaps& out) {
  const int w = maps.phase_rad.width(), h = maps.phase_rad.height();
  if (out.weight.width() != w || out.weight.height() != h) {
    out.weight = Map<float>(w, h);
    out.turn = Map<std::int16_t>(w, h);
  }
  std::fill(out.weight.pixels().begin(), out.weight.pixels().end(), 0.0F);
  RowState state(static_cast<std::size_t>(w));
  for (auto next = spans.begin(); next != spans.end();) {
    const std::int32_t v = next->row, begin = next->begin;
    std::int32_t end = begin;
    state.clear();
    for (; next != spans.end() && next->row == v; ++next) {
      state.add(*next, signs);
      end = next->end;
    }
    solve_polarity_row(state.row(), out.weight.index(0, v), static_cast<std::size_t>(begin),
                       static_cast<std::size_t>(end), noise, config, maps, out);
  }
}

}  // namespace enamel::algo
