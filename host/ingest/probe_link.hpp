// The host's end of the link to one probe: finds it, opens a session, gives commands, follows its state and its clock.
// Used by one thread (the ingest thread). Times on injected clock; no waiting but in wait_data().
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/ingest/clock_map.hpp"
#include "protocol/base/clock.hpp"
#include "protocol/base/result.hpp"
#include "protocol/dds/participant.hpp"
#include "protocol/dds/topics.hpp"
#include "protocol/types/device.hpp"

namespace enamel::host {

struct ProbeLinkConfig {
  std::string serial;           ///< empty: the only probe there is
  std::uint32_t client_id = 0;  ///< of this host; 0 = drawn from the clock
  Nanoseconds command_timeout{2'000'000'000};
  Nanoseconds command_retry{200'000'000};
  Nanoseconds lease_renewal{1'000'000'000};  ///< the probe pauses when nothing came for 3 s
  Nanoseconds time_sync_period{500'000'000};
  Nanoseconds silence{3'000'000'000};  ///< without a status of the probe: it is gone, whoever else is on the network
};

/// What arrived since the last poll, in order of topics: nothing is dropped here.
struct LinkInput {
  std::vector<dds::Received<proto::Burst>> bursts;
  std::vector<proto::Status> statuses;
  std::vector<proto::Event> events;
};

class ProbeLink {
 public:
  /// Errors: kDds.
  [[nodiscard]] static Result<std::unique_ptr<ProbeLink>> create(const dds::Participant& participant,
                                                                 const ProbeLinkConfig& config, Clock& clock);

  /// Looks once for the probe. nullopt: none yet. Errors: kProbeAmbiguous with the serials seen; kProbeVersion.
  [[nodiscard]] Result<std::optional<proto::DeviceInfo>> find();

  /// Why find() finds none, as far as the network tells: kProbeVersion where programs of another version are on it,
  /// else kProbeNotFound.
  [[nodiscard]] Error not_found() const;

  /// Sends a command and waits for its reply, re-sending the same cmd_id until then; bursts that arrive meanwhile are
  /// kept for poll(). Errors: kProbeLost (no reply), kProbeRefused (with the probe's reason), kDds.
  [[nodiscard]] Result<proto::CommandReply> command(proto::Opcode opcode, std::array<std::int64_t, 4> args = {},
                                                    const std::string& text = {});

  /// Waits for a burst or `timeout`.
  void wait_data(Nanoseconds timeout);
  /// Takes everything that has come, renews the lease and exchanges clocks when due.
  [[nodiscard]] Result<LinkInput> poll();
  void wake() { bursts_.wake(); }

  /// A status writer is alive, and the probe's own status has come within `silence`.
  [[nodiscard]] bool alive() const;
  [[nodiscard]] const std::optional<proto::DeviceInfo>& probe() const noexcept { return probe_; }
  [[nodiscard]] const std::optional<proto::Status>& last_status() const noexcept { return status_; }
  [[nodiscard]] const ClockMap& clock_map() const noexcept { return clock_map_; }

 private:
  struct Ends;
  ProbeLink(const dds::Participant& participant, Ends ends, const ProbeLinkConfig& config, Clock& clock);
  [[nodiscard]] Result<std::optional<proto::DeviceInfo>> take(const proto::DeviceInfo& info);
  [[nodiscard]] Result<void> send(const proto::Command& command);
  void keep_alive();
  void take_time_sync();

  ProbeLinkConfig config_;
  Clock& clock_;
  dds::Participant participant_;
  dds::Reader<proto::DeviceInfo> infos_;
  dds::Reader<proto::Status> statuses_;
  dds::Reader<proto::Event> events_;
  dds::Reader<proto::Burst> bursts_;
  dds::Reader<proto::CommandReply> replies_;
  dds::Writer<proto::Command> commands_;
  dds::Reader<proto::TimeSyncRep> sync_replies_;
  dds::Writer<proto::TimeSyncReq> sync_requests_;

  std::vector<proto::DeviceInfo> seen_;
  std::optional<proto::DeviceInfo> probe_;
  std::optional<proto::Status> status_;
  HostTime status_came_{};
  ClockMap clock_map_;
  std::uint64_t next_cmd_id_ = 1;
  std::uint32_t sync_seq_ = 0;
  HostTime next_renewal_{}, next_sync_{};
  bool session_open_ = false;
};

}  // namespace enamel::host
