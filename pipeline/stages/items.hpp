// What travels between the stages of a scan. Immutable once emitted.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "pipeline/decode/phase/wave_knowledge.hpp"
#include "pipeline/model/segments/patch_store.hpp"
#include "pipeline/types/order_check.hpp"
#include "pipeline/types/patch.hpp"
#include "pipeline/types/probe_motion.hpp"
#include "pipeline/types/relative_surface.hpp"
#include "pipeline/types/sight.hpp"
#include "pipeline/types/track.hpp"
#include "protocol/types/burst.hpp"

namespace enamel::stage {

/// Digests of what the stages before made of the burst; see pipeline/stages/digest.hpp.
struct Digests {
  std::uint64_t input = 0, decode = 0, track = 0, fuse = 0;
};

struct Decoded {
  SurfacePatch patch;
  RelativeSurface relative;
  BurstMotion motion;
  std::optional<pipeline::Waveform> wave_shown;  ///< what the burst alone shows of the projector's waveform
  Digests digests;
  Sight sight;
};

struct Tracked {
  std::shared_ptr<const SurfacePatch> patch;  ///< what the burst decoded to, with what the model decided of the rest
  BurstMotion motion;
  TrackResult result;
  OrderCheck orders;
  Digests digests;
  Sight sight;
  std::uint8_t soft_below = kNothingSoft;  ///< shades below it are soft tissue's, by all bursts so far
};

struct Fused {
  TrackResult track;
  OrderCheck orders;
  BurstMotion motion;
  Digests digests;
  Sight sight;
  pipeline::StoredPatch kept = {};         ///< the patch, where bursts are kept
  std::uint8_t soft_below = kNothingSoft;  ///< as Tracked
};

}  // namespace enamel::stage
