#include "pipeline/stages/decode_stage.hpp"

#include <algorithm>
#include <utility>

#include "pipeline/stages/burst_view.hpp"

namespace enamel::stage {
namespace {

/// The surface's motion per frame as the camera's per second.
BurstMotion motion_of(const proto::Burst& burst, const pipeline::RigidMotion& surface) {
  BurstMotion out;
  out.exposure_spread_s2 = proto::exposure_spread_s2(burst);
  const double period_s = proto::frame_period_s(burst);
  if (!surface.moved || !(period_s > 0)) return out;
  out.twist = ProbeTwist{-Vec3d(surface.shift_mm.data()) / period_s, -Vec3d(surface.turn_rad.data()) / period_s,
                         surface.about_mm};
  return out;
}

/// Frames are compared with each other, and for that must have been exposed alike.
bool exposed_alike(const proto::Burst& burst) {
  const auto differ = [](const proto::FrameMeta& a, const proto::FrameMeta& b) {
    return a.exposure_us != b.exposure_us || a.analogue_gain_q8 != b.analogue_gain_q8;
  };
  return std::ranges::adjacent_find(burst.meta, differ) == burst.meta.end();
}

/// Frames that another lamp spoils look like a wrong pattern or like none.
const char* reason_of(const pipeline::DecodedBurst& decoded) {
  return decoded.sight.trouble == SightTrouble::kLamp ? "other_light" : pipeline::name_of(decoded.verdict).data();
}

}  // namespace

Result<void> DecodeStage::step() {
  const auto item = burst.take();
  const auto known = wave.take();
  if (calib_crc32_ != 0 && item->calib_crc32 != calib_crc32_) {
    patch.emit(flow::make_rejected<Decoded>(item, "foreign_calibration"));
    return {};
  }
  if (!exposed_alike(*item)) {
    patch.emit(flow::make_rejected<Decoded>(item, "exposure_changed"));
    return {};
  }
  pipeline::DecodedBurst decoded;
  decoder_->decode(view_of(*item), workspace_, decoded, {{}, *known});
  if (!decoded.accepted()) {
    patch.emit(flow::make_rejected<Decoded>(item, reason_of(decoded)));
    return {};
  }
  Decoded out{std::move(decoded.patch),
              std::move(decoded.relative),
              motion_of(*item, decoded.diagnostics.rigid),
              decoded.diagnostics.wave_shown,
              {},
              decoded.sight};
  out.digests.input = Digest().add(std::span<const std::uint8_t>(item->payload)).value();
  // Normals follow from depth; registration, which uses them, is digested next.
  out.digests.decode = Digest().add(out.patch.depth_mm).add(out.patch.sigma_mm).add(out.patch.texture_dn).value();
  patch.emit(flow::make_item<Decoded>(item, std::move(out)));
  return {};
}

}  // namespace enamel::stage
