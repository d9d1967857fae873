// Mode M: narrow strips of another surface along the ends of a row's runs. Beside a tooth that is higher than the gum
// by exactly one fringe the phase goes on as if there were no step, and a strip of gum of a few pixels before a shadow
// or the picture's border says too little in one row to be found as a segment of its own. Its pixels' code frames,
// summed along the edge over the rows, say enough: where one order more or less explains them better, they are of the
// other surface. Private to pipeline/decode.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/decode/mode_m/chosen.hpp"
#include "pipeline/decode/phase/cell_span.hpp"
#include "pipeline/decode/phase/pixel_reject.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::pipeline {

/// By what the neighbouring orders explain a row's code frame better than the orders given: differences of the log
/// likelihood, held to +-4 so that no pixel decides alone; 0 where order or code is unknown.
struct OrderDoubt {
  float *one_more, *one_less;
};

/// One burst's; keeps its memory between bursts. Not thread-safe.
class CodeStrips {
 public:
  /// spans: decided cells in the order of rows, as place_spans takes them. Those that touch make a run, but for where
  /// the order jumps.
  void find_ends(std::span<const CellSpan> spans, int height);

  /// What the pixels of row v say; each row once.
  void take_row(int v, const OrderDoubt& doubt);

  /// Pixels of strips whose code speaks for another order by more than `evidence` (log likelihood ratio, summed along
  /// the edge), so far accepted, become kRelative. Returns their number.
  std::size_t withdraw(float evidence, Map<PixelReject>& reject);

 private:
  struct End {
    std::int32_t column, length_px;  ///< outermost pixel of the run, and all of them
    std::int32_t above;              ///< the same edge in the row above, or -1
  };
  using Doubts = std::array<std::array<float, kMostStrip_px>, 2>;  ///< of one order more and less; from the end inwards

  /// Ends on one side of the runs: step is +1 on the left, where the run goes on to the right, or -1.
  struct Side {
    int step = 1;
    std::vector<End> ends;
    std::vector<std::size_t> first_of_row;
    std::vector<Doubts> seen, summed;
  };

  static void link(Side& side);
  static void sum_along_edges(Side& side);

  std::array<Side, 2> sides_;
};

}  // namespace enamel::pipeline
