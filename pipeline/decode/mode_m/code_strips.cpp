#include "pipeline/decode/mode_m/code_strips.hpp"

#include <algorithm>
#include <cstdlib>

namespace enamel::pipeline {
namespace {

/// Pixels from the end inwards that are best taken out, and what speaks for that.
struct Cut {
  std::size_t px = 0;
  float evidence = 0;
};

Cut best_cut(std::span<const float> doubts) {
  Cut best;
  float sum = 0;
  for (std::size_t k = 0; k < doubts.size(); ++k) {
    sum += doubts[k];
    if (sum > best.evidence) best = {k + 1, sum};
  }
  return best;
}

/// Without a gap and without a jump of a whole fringe.
bool goes_on(const CellSpan& a, const CellSpan& b) {
  return a.row == b.row && a.end == b.begin && std::abs(a.cell - b.cell) <= 1;
}

}  // namespace

void CodeStrips::find_ends(std::span<const CellSpan> spans, int height) {
  sides_[0].step = 1, sides_[1].step = -1;
  for (Side& side : sides_) side.ends.clear(), side.first_of_row.clear();
  std::size_t k = 0;
  for (int v = 0; v <= height; ++v) {
    for (Side& side : sides_) side.first_of_row.push_back(side.ends.size());
    while (k < spans.size() && spans[k].row == v) {
      const std::int32_t begin = spans[k++].begin;
      while (k < spans.size() && goes_on(spans[k - 1], spans[k])) ++k;
      const std::int32_t end = spans[k - 1].end;
      sides_[0].ends.push_back({begin, end - begin, -1});
      sides_[1].ends.push_back({end - 1, end - begin, -1});
    }
  }
  for (Side& side : sides_) {
    link(side);
    side.seen.assign(side.ends.size(), {});
  }
}

void CodeStrips::link(Side& side) {
  for (std::size_t row = 1; row + 1 < side.first_of_row.size(); ++row) {
    std::size_t o = side.first_of_row[row - 1];
    const std::size_t stop = side.first_of_row[row];
    for (std::size_t k = stop; k < side.first_of_row[row + 1]; ++k) {
      End& end = side.ends[k];
      while (o < stop && side.ends[o].column < end.column - kEdgeDrift_px) ++o;
      if (o < stop && side.ends[o].column <= end.column + kEdgeDrift_px) end.above = static_cast<std::int32_t>(o);
    }
  }
}

void CodeStrips::take_row(int v, const OrderDoubt& doubt) {
  const auto row = static_cast<std::size_t>(v);
  for (Side& side : sides_) {
    for (std::size_t k = side.first_of_row[row]; k < side.first_of_row[row + 1]; ++k) {
      const End& end = side.ends[k];
      const auto count = std::min(kMostStrip_px, static_cast<std::size_t>(end.length_px));
      for (std::size_t j = 0; j < count; ++j) {
        const std::ptrdiff_t u = end.column + side.step * static_cast<std::ptrdiff_t>(j);
        side.seen[k][0][j] = doubt.one_more[u], side.seen[k][1][j] = doubt.one_less[u];
      }
    }
  }
}

/// Every row's own doubts and those of the rows above and below, each row further off by kEdgeMemory less.
void CodeStrips::sum_along_edges(Side& side) {
  const auto add = [](const Doubts& from, Doubts& to) {
    for (std::size_t s = 0; s < from.size(); ++s)
      for (std::size_t j = 0; j < kMostStrip_px; ++j) to[s][j] += kEdgeMemory * from[s][j];
  };
  std::vector<Doubts>& down = side.summed;
  down = side.seen;
  for (std::size_t k = 0; k < side.ends.size(); ++k)
    if (side.ends[k].above >= 0) add(down[static_cast<std::size_t>(side.ends[k].above)], down[k]);
  std::vector<Doubts>& up = side.seen;  // becomes the sum of its row and those below
  for (std::size_t k = side.ends.size(); k-- > 0;) {
    Doubts below = up[k];
    if (side.ends[k].above >= 0) add(below, up[static_cast<std::size_t>(side.ends[k].above)]);
    for (std::size_t s = 0; s < below.size(); ++s)
      for (std::size_t j = 0; j < kMostStrip_px; ++j) down[k][s][j] += below[s][j];
  }
}

std::size_t CodeStrips::withdraw(float evidence, Map<PixelReject>& reject) {
  std::size_t withdrawn = 0;
  for (Side& side : sides_) {
    sum_along_edges(side);
    for (std::size_t k = 0, row = 0; k < side.ends.size(); ++k) {
      while (side.first_of_row[row + 1] <= k) ++row;
      const auto count = std::min(kMostStrip_px, static_cast<std::size_t>(side.ends[k].length_px));
      std::size_t strip_px = 0;
      for (const auto& doubts : side.summed[k]) {
        const Cut cut = best_cut({doubts.data(), count});
        if (cut.evidence > evidence) strip_px = std::max(strip_px, cut.px);
      }
      for (std::size_t j = 0; j < strip_px; ++j) {
        PixelReject& why = reject(side.ends[k].column + side.step * static_cast<int>(j), static_cast<int>(row));
        withdrawn += why == PixelReject::kNone ? 1U : 0U;
        if (why == PixelReject::kNone) why = PixelReject::kRelative;
      }
    }
  }
  return withdrawn;
}

}  // namespace enamel::pipeline
