// Which shifts a segment is asked about: kOrderStates of them, from its base on. Private to pipeline/decode.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/decode/unwrap/order.hpp"

namespace enamel::pipeline {

/// Orders beyond the depth range that a surface is followed. chosen: by judgement; mode M's code ratio is made for it
/// (docs/adr/0007-mode-m-becomes-the-default.md).
inline constexpr std::int32_t kBeyond = 2;

/// Fills work.base, the shift of each segment's first state: one for all segments of a component where their depth
/// range and kBeyond on both sides fit. Where the flood leaked between surfaces many fringes apart they do not, and
/// segments that lie close together share one: of those left, always the window that holds most pixels.
void find_bases(const std::vector<Segment>& segments, std::int32_t components, OrderResult::Work& work);

}  // namespace enamel::pipeline
