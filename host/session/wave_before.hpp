// What a scan has learned of its projector by the time it decodes a burst: for programs that decode one by itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "host/record/burst_stream.hpp"
#include "pipeline/decode/burst_decoder.hpp"
#include "protocol/base/ids.hpp"

namespace enamel::host {

/// Bursts by which the decoders of a scan get late what is learned. layout: as many as are under way at once between
/// two decoders and the stage behind them, or in four decoders.
inline constexpr std::size_t kWaveDelay = 4;

/// Decodes the bursts before `burst`, in the stream's order, up to where nothing more is learned. Rewinds the stream
/// first; damaged records are passed over, bursts that name another calibration than calib_crc32 tell nothing (0: any),
/// as in a scan. on_burst: after each one, its place in that order; may be empty.
[[nodiscard]] pipeline::WaveKnowledge wave_before(BurstStream& stream, BurstId burst,
                                                  const pipeline::BurstDecoder& decoder, std::uint32_t calib_crc32,
                                                  const std::function<void(std::uint64_t)>& on_burst);

}  // namespace enamel::host
