// All quality of service in one table. One row a type; writer and reader of a topic use the same row.
#pragma once

#include <cstdint>
#include <string_view>

#include "protocol/types/axes.hpp"
#include "protocol/types/burst.hpp"
#include "protocol/types/device.hpp"

namespace enamel::dds {

struct TopicQos {
  std::string_view topic;
  bool reliable;
  bool transient_local;          ///< a reader that comes later gets the last samples (all of them with KEEP_ALL)
  int history;                   ///< KEEP_LAST depth, 0 = KEEP_ALL
  int reader_max_samples;        ///< with KEEP_ALL: the reader's bound, after which the writer is held back
  std::int64_t max_blocking_ms;  ///< how long a write may wait for room
  std::int64_t lifespan_ms;      ///< 0 = for ever
};

/// Liveliness of every writer: automatic, with this lease. A dead peer is known within it.
inline constexpr std::int64_t kLivelinessLeaseMs = 2000;

template <class T>
inline constexpr TopicQos kQos{};

// Bursts: nothing that was written may vanish unseen, so history is KEEP_ALL on both ends and no lifespan. KEEP_LAST
// drops the oldest burst without a trace when the host is late by its depth, and a lifespan does the same on a loaded
// machine; both would count as lost on the wire. Instead a slow host holds the writer back: write() waits, the probe's
// own queue fills and sheds, counted, before a burst_seq is spent. Freshness is the business of the host's one shedding
// place.
template <>
inline constexpr TopicQos kQos<proto::Burst>{"enamel/v1/burst", true, false, 0, 64, 1000, 0};
template <>
inline constexpr TopicQos kQos<proto::DeviceInfo>{"enamel/v1/device_info", true, true, 1, 0, 100, 0};
template <>
inline constexpr TopicQos kQos<proto::Status>{"enamel/v1/status", true, true, 1, 0, 100, 0};
template <>
inline constexpr TopicQos kQos<proto::Event>{"enamel/v1/event", true, true, 64, 0, 100, 0};
// One angle missing spoils a scan of the table, so every one is kept and told to whoever comes later; they are small.
// A reader passes over those of another session_id.
template <>
inline constexpr TopicQos kQos<proto::AxesReading>{"enamel/v1/axes", true, true, 0, 0, 100, 0};
// A command must not be executed by a probe that starts later, nor long after it was given.
template <>
inline constexpr TopicQos kQos<proto::Command>{"enamel/v1/command", true, false, 16, 0, 100, 1000};
template <>
inline constexpr TopicQos kQos<proto::CommandReply>{"enamel/v1/command_reply", true, false, 16, 0, 100, 0};
template <>
inline constexpr TopicQos kQos<proto::TimeSyncReq>{"enamel/v1/timesync_req", false, false, 1, 0, 0, 0};
template <>
inline constexpr TopicQos kQos<proto::TimeSyncRep>{"enamel/v1/timesync_rep", false, false, 1, 0, 0, 0};

}  // namespace enamel::dds
