// Own encoder and decoder of every type of scanner.idl: recordings are read and written without DDS, and live bursts
// take the same decoder. Bytes equal Cyclone's, including the 4-byte encapsulation header: @final types are plain XCDR1
// little endian (00 01), @appendable ones delimited XCDR2 little endian (00 09); the last two header bits count padding
// bytes. Reference: OMG DDS-XTypes 1.3 section 7.4; RTPS 2.5 section 10.2. Pure functions, thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/base/result.hpp"
#include "protocol/types/axes.hpp"
#include "protocol/types/burst.hpp"
#include "protocol/types/device.hpp"

namespace enamel::proto {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

/// T: Burst, DeviceInfo, Status, Command, CommandReply, Event, TimeSyncReq, TimeSyncRep, AxesReading, ShedNote.
/// Errors: kMessageInvalid when a string or sequence is longer than its bound, an angle beyond its own.
template <class T>
[[nodiscard]] Result<Bytes> to_cdr(const T& value);

/// Whatever the bytes hold, the answer is a value or kMessageInvalid. An @appendable type may carry members added by a
/// later minor version: they are skipped.
template <class T>
[[nodiscard]] Result<T> from_cdr(ByteView cdr);

}  // namespace enamel::proto
