#include "pipeline/stages/decode_stage.hpp"

#include <utility>

#include "pipeline/stages/burst_view.hpp"

namespace enamel::stage {

Result<void> DecodeStage::step() {
  const auto item = burst.take();
  if (calib_crc32_ != 0 && item->calib_crc32 != calib_crc32_) {
    patch.emit(graph::make_rejected<Decoded>(item, "foreign_calibration"));
    return {};
  }
  algo::DecodedBurst decoded;
  decoder_->decode(view_of(*item), workspace_, decoded);
  if (!decoded.accepted()) {
    patch.emit(graph::make_rejected<Decoded>(item, algo::name_of(decoded.verdict).data()));
    return {};
  }
  Decoded out{std::move(decoded.patch), {}};
  out.digests.input = Digest().add(std::span<const std::uint8_t>(item->payload)).value();
  // Normals follow from depth; registration, which uses them, is digested next.
  out.digests.decode = Digest().add(out.patch.depth_mm).add(out.patch.sigma_mm).add(out.patch.texture_dn).value();
  patch.emit(graph::make_item<Decoded>(item, std::move(out)));
  return {};
}

}  // namespace enamel::stage
