// Which exposures a stop needs beside the probe's own: shorter ones where it glares, longer ones where it is too dark.
#pragma once

#include <cstdint>
#include <vector>

#include "protocol/types/burst.hpp"

namespace enamel::host {

struct ExposureConfig {
  int exposures = 0;  ///< at a stop: 1 the probe's own, 2 a shorter one too, 3 a longer one too; 0: as the light needs
  double ratio = 4;   ///< chosen: by judgement; of one exposure to the next; 8-bit fringes bear two such steps
  double min_glare = 0.003;  ///< chosen: plain stone shows none; of lit pixels, clipped ones …
  double min_dim = 0.03;  ///< … and dim ones, from which on auto takes more; plain stone 0.006, dark dies 0.1 and more
  int seen_levels = 3;    ///< derived: of 255; noise alone spreads four frames of a dark pixel by two
  int sound_levels = 8;   ///< derived: fringes that spread less have a phase noise above half of what is let pass
};

/// Of the pixels that the light reaches, over all four frames.
struct LightShares {
  double glare = 0;  ///< clipped in one frame or more
  double dim = 0;    ///< lit, and fringes too faint
};

/// Needs is_consistent(burst).
[[nodiscard]] LightShares light_shares(const proto::Burst& burst, const ExposureConfig& config);

/// What a stop needs beside the exposure of its first burst, us, in the order to take them. A longer one is no longer
/// than the burst's frame period lets it be, and is left out where that gains too little. Needs is_consistent(first).
[[nodiscard]] std::vector<std::uint32_t> further_exposures(const proto::Burst& first, const ExposureConfig& config);

/// Whether the burst was exposed as asked, as nearly as cameras that count in lines can.
[[nodiscard]] bool is_exposed(const proto::Burst& burst, std::uint32_t exposure_us) noexcept;

}  // namespace enamel::host
