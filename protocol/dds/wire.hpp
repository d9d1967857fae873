// From plain values to the structs that idlc generated. Private to this folder.
#pragma once

#include <scanner.h>

#include "protocol/base/result.hpp"
#include "protocol/types/axes.hpp"
#include "protocol/types/burst.hpp"
#include "protocol/types/device.hpp"

namespace enamel::dds {

template <class T>
struct Wire;

/// Sequences of the wire struct point into the value: it must outlive the wire struct and nothing may free it.
#define ENAMEL_WIRE(T)                                                                          \
  template <>                                                                                   \
  struct Wire<proto::T> {                                                                       \
    using Type = enamel_v1_##T;                                                                 \
    static const dds_topic_descriptor_t& descriptor() noexcept { return enamel_v1_##T##_desc; } \
    [[nodiscard]] static Result<void> fill(Type& wire, const proto::T& value);                  \
  };
ENAMEL_WIRE(Burst)
ENAMEL_WIRE(DeviceInfo)
ENAMEL_WIRE(Status)
ENAMEL_WIRE(Command)
ENAMEL_WIRE(CommandReply)
ENAMEL_WIRE(Event)
ENAMEL_WIRE(TimeSyncReq)
ENAMEL_WIRE(TimeSyncRep)
ENAMEL_WIRE(AxesReading)
ENAMEL_WIRE(ShedNote)
#undef ENAMEL_WIRE

}  // namespace enamel::dds
