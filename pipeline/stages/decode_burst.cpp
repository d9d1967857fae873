#include "pipeline/stages/decode_burst.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "pipeline/stages/burst_view.hpp"
#include "pipeline/stages/digest.hpp"
#include "pipeline/tissue/shade_of.hpp"

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

/// Plaster, by the rule by which light from inside is told, has none.
ShadeMap shade_of_burst(const pipeline::BurstDecoder& decoder, const proto::Burst& burst,
                        const pipeline::DecodedBurst& decoded) {
  const double least = decoder.config().translucency.least_share;
  if (burst.meta.empty() || static_cast<double>(decoded.sight.translucent_share) < least) return {};
  const proto::FrameMeta& frame = burst.meta.front();
  const float gain = static_cast<float>(frame.analogue_gain_q8) / 256.0F;
  return pipeline::shade_of(
      decoded.patch, {decoder.rays().projector_mm, decoder.opaque_contrast(decoded.diagnostics), decoded.sight.veil_dn,
                      static_cast<float>(frame.exposure_us) * 1e-3F * gain});
}

}  // namespace

DecodedOrNot decode_burst(const pipeline::BurstDecoder& decoder, const proto::Burst& burst, std::uint32_t calib_crc32,
                          const pipeline::WaveKnowledge& wave, pipeline::DecodeWorkspace& workspace) {
  if (calib_crc32 != 0 && burst.calib_crc32 != calib_crc32) return {std::nullopt, "foreign_calibration"};
  if (!exposed_alike(burst)) return {std::nullopt, "exposure_changed"};
  pipeline::DecodedBurst decoded;
  decoder.decode(view_of(burst), workspace, decoded, {{}, wave});
  if (!decoded.accepted()) return {std::nullopt, reason_of(decoded)};
  decoded.patch.shade = shade_of_burst(decoder, burst, decoded);
  Decoded out{std::move(decoded.patch),
              std::move(decoded.relative),
              motion_of(burst, decoded.diagnostics.rigid),
              decoded.diagnostics.wave_shown,
              {},
              decoded.sight};
  out.digests.input = Digest().add(std::span<const std::uint8_t>(burst.payload)).value();
  // Normals follow from depth; registration, which uses them, is digested next.
  Digest digest;
  digest.add(out.patch.depth_mm).add(out.patch.sigma_mm).add(out.patch.texture_dn);
  if (!out.patch.shade.empty()) digest.add(std::span<const std::uint8_t>(out.patch.shade.pixels()));
  out.digests.decode = digest.value();
  return {std::move(out), nullptr};
}

}  // namespace enamel::stage
