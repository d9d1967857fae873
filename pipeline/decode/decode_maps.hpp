// A decoded burst as files: what `enamel decode` promises (docs of the command: names, units, conventions).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/decode/steps/decoded_burst.hpp"
#include "protocol/base/result.hpp"

namespace enamel::pipeline {

struct DecodeReport {
  std::uint64_t burst = 0;
  std::string_view mode;                                 ///< as rig.json says it
  std::vector<Figure> figures;                           ///< BurstDecoder::figures
  std::vector<std::pair<std::string, double>> stage_ms;  ///< in order of execution
};

/// Writes phase.pfm modulation.pfm order.png reject.png depth.pfm sigma.pfm points.ply decode.json into `folder`, made
/// when absent. Each file appears whole or not at all. Errors: kFileWrite.
[[nodiscard]] Result<void> write_decode_maps(const DecodedBurst& burst, const DecodeReport& report,
                                             const std::string& folder);

/// decode.json alone.
[[nodiscard]] std::string decode_json(const DecodedBurst& burst, const DecodeReport& report);

/// One-channel PFM: little endian, rows bottom-up.
[[nodiscard]] std::string pfm_bytes(const Map<float>& map);

/// Binary PLY of all points with normals (nx ny nz; 0 0 0 where there is none) and grey value.
[[nodiscard]] std::string points_ply(const SurfacePatch& patch);

}  // namespace enamel::pipeline
