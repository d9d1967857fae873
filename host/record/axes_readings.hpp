// Angles of the desktop scanner's axes as a recording or folder has them.
#pragma once

#include <vector>

#include "host/record/burst_stream.hpp"
#include "protocol/types/axes.hpp"

namespace enamel::host {

/// One reading for every burst that can be read, in their order, with the burst's own probe and session. They are those
/// of the channel enamel/v1/axes; where the recording has no message of it, those of the attachment axes.csv, their
/// stops numbered as number_stops() does. Reads the stream from begin to end, passing over what is damaged, and rewinds
/// it: once a run, not once a burst. Errors: kAxesMissing (neither channel nor table; or, with its number, the first
/// burst that has no angles); kExchangeInvalid (channel and table differ, or the channel contradicts itself, with the
/// first burst; a table that is malformed); kCaptureCorrupt (the table, where nothing else tells); kFileRead.
[[nodiscard]] Result<std::vector<proto::AxesReading>> axes_of(BurstStream& stream);

/// How many angles there are: messages, or where there are none, rows of a table that can be read.
[[nodiscard]] std::uint64_t count_axes(BurstStream& stream);

}  // namespace enamel::host
