// Rows of a mode M burst with the angles by which their orders turn the code. Private to algo/phase and algo/decode.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "pipeline/algo/phase/micro_refit.hpp"
#include "pipeline/algo/phase/micro_refit_rows.hpp"

namespace enamel::algo {

/// Calls visit(v, order_cos, order_sin) for every row of the image that has spans, top down.
template <class Visit>
void each_code_row(std::span<const CellSpan> spans, const Map<std::int16_t>& turn, const MicroCode& code,
                   const Visit& visit) {
  const auto width = static_cast<std::size_t>(turn.width());
  const int last = static_cast<int>(code.cosine.size()) - 1;
  std::vector<float> cosine(width), sine(width);
  for (std::size_t k = 0; k < spans.size();) {
    const std::int32_t row = spans[k].row;
    std::fill(cosine.begin(), cosine.end(), 0.0F);
    std::fill(sine.begin(), sine.end(), 0.0F);
    for (; k < spans.size() && spans[k].row == row; ++k) {
      const auto order = static_cast<std::size_t>(std::clamp<int>(turn(spans[k].begin, row), 0, last));
      std::fill(cosine.begin() + spans[k].begin, cosine.begin() + spans[k].end, code.cosine[order]);
      std::fill(sine.begin() + spans[k].begin, sine.begin() + spans[k].end, code.sine[order]);
    }
    visit(row, cosine.data(), sine.data());
  }
}

/// The row whose first pixel is `at`.
inline CodeRow code_row_of(const MicroMotion& motion, const MicroCode& code, float third_rad, std::size_t at,
                           const float* cosine, const float* sine) {
  return {cosine,
          sine,
          &motion.pixel_motion_rad[at],
          &motion.pixel_gain[at],
          &motion.pixel_light[at],
          &motion.pixel_motion_change_rad[at],
          &motion.pixel_light_change[at],
          code.inverse_ratio,
          -third_rad,
          motion.black_dn};
}

}  // namespace enamel::algo
