#include "pipeline/decode/pattern_modes.hpp"

#include <utility>

namespace enamel::pipeline {

Result<PatternCode> read_pattern_code(const calib::Rig& rig) {
  if (rig.patterns.mode != calib::PatternMode::kMicro) {
    ENAMEL_TRY_ASSIGN(CellSigns signs, make_cell_signs(rig.patterns, rig.projector));
    return PatternCode(std::move(signs));
  }
  ENAMEL_TRY_ASSIGN(MicroCode code, make_micro_code(rig.patterns, rig.projector));
  if (!rig.noise) return fail(ErrorCode::kRigInvalid, "key 'noise' is missing, and mode M cannot tell it from a burst");
  return PatternCode(std::move(code));
}

Result<void> check_code_decides(const PatternCode& code, const calib::PatternValues& patterns, double span_fringes) {
  if (std::holds_alternative<MicroCode>(code)) return check_orders_differ(patterns.code_ratio, span_fringes);
  // A single marker, or none, leaves regions undecided by design.
  if (patterns.mode != calib::PatternMode::kPolarity) return {};
  return check_windows_differ(std::get<CellSigns>(code), span_fringes);
}

std::shared_ptr<const PatternStrategy> make_strategy(PatternCode code, BurstGeometry geometry,
                                                     const DecodeConfig& config) {
  if (auto* micro = std::get_if<MicroCode>(&code))
    return std::make_shared<MicroMode>(std::move(*micro), std::move(geometry), config, config.micro);
  auto& signs = std::get<CellSigns>(code);
  if (!signs.informative)
    return std::make_shared<PlainFourStep>(std::move(signs), std::move(geometry), config, config.four_step);
  return std::make_shared<FourStepMode>(std::move(signs), std::move(geometry), config, config.four_step);
}

}  // namespace enamel::pipeline
