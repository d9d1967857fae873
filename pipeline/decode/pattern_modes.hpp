// The one place that asks a rig which pattern mode it projects. Private to pipeline/decode.
#pragma once

#include <memory>
#include <variant>

#include "calib/model/rig.hpp"
#include "pipeline/decode/decode_config.hpp"
#include "pipeline/decode/mode_m/micro_code.hpp"
#include "pipeline/decode/mode_t/cell_signs.hpp"
#include "pipeline/decode/steps/pattern_strategy.hpp"

namespace enamel::pipeline {

/// The rig's pattern set as data, by what it takes to decode it.
using PatternCode = std::variant<CellSigns, MicroCode>;

/// Errors: kPatternSet (mode multi, fringes along v), kRigInvalid (mode M without `noise`, which no closure residual
/// can stand in for).
[[nodiscard]] Result<PatternCode> read_pattern_code(const calib::Rig& rig);

/// Whether the code tells apart the orders that a depth range of span_fringes leaves open at one pixel. Error:
/// kPatternAmbiguous.
[[nodiscard]] Result<void> check_code_decides(const PatternCode& code, const calib::PatternValues& patterns,
                                              double span_fringes);

[[nodiscard]] std::shared_ptr<const PatternStrategy> make_strategy(PatternCode code, BurstGeometry geometry,
                                                                   const DecodeConfig& config);

}  // namespace enamel::pipeline
