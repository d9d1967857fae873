// Which shifts a segment is asked about: kOrderStates of them, from its base on. Private to pipeline/decode.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/decode/unwrap/chosen.hpp"
#include "pipeline/decode/unwrap/order.hpp"

namespace enamel::pipeline {

/// Fills work.base, the shift of each segment's first state: one for all segments of a component where their depth
/// range and kBeyond on both sides fit. Where the flood leaked between surfaces many fringes apart they do not, and
/// segments that lie close together share one: of those left, always the window that holds most pixels.
void find_bases(const std::vector<Segment>& segments, std::int32_t components, OrderResult::Work& work);

}  // namespace enamel::pipeline
