// The labelling's numeric part: messages along rows, means between rows, choice. Private to pipeline/decode.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/decode/unwrap/order.hpp"

namespace enamel::pipeline {

/// Fills `shift` and `decided` of all segments from what they, their rows and the rows around them say. Left in `work`:
/// row, what each segment's own row says; up and down, whose mean the choice was made by; margin, how clear it was.
void label_rows(const std::vector<Segment>& segments, std::int32_t components, const CodeEvidence& evidence,
                const OrderConfig& config, OrderResult& out);

/// Whether a shift beyond the segment's depth range shows the code of one within, for a code that repeats after
/// `period` orders; 0: it never does.
[[nodiscard]] inline bool repeats_range(const Segment& segment, std::int32_t shift, std::int32_t period) {
  if (period == 0) return false;
  return (shift < segment.low && shift + period <= segment.high) ||
         (shift > segment.high && shift - period >= segment.low);
}

}  // namespace enamel::pipeline
