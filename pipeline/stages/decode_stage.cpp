#include "pipeline/stages/decode_stage.hpp"

#include <utility>

#include "pipeline/stages/decode_burst.hpp"

namespace enamel::stage {

Result<void> DecodeStage::step() {
  const auto item = burst.take();
  const auto known = wave.take();
  DecodedOrNot out = decode_burst(*decoder_, *item, calib_crc32_, *known, workspace_);
  if (out.decoded) {
    patch.emit(flow::make_item<Decoded>(item, std::move(*out.decoded)));
  } else {
    patch.emit(flow::make_rejected<Decoded>(item, out.rejected));
  }
  return {};
}

}  // namespace enamel::stage
