#include "host/ingest/probe_link.hpp"

#include <algorithm>
#include <utility>

namespace enamel::host {

struct ProbeLink::Ends {
  dds::Reader<proto::DeviceInfo> infos;
  dds::Reader<proto::Status> statuses;
  dds::Reader<proto::Event> events;
  dds::Reader<proto::Burst> bursts;
  dds::Reader<proto::CommandReply> replies;
  dds::Writer<proto::Command> commands;
  dds::Reader<proto::TimeSyncRep> sync_replies;
  dds::Writer<proto::TimeSyncReq> sync_requests;
};

Result<std::unique_ptr<ProbeLink>> ProbeLink::create(const dds::Participant& participant, const ProbeLinkConfig& config,
                                                     Clock& clock) {
  ENAMEL_TRY_ASSIGN(auto bursts, dds::Reader<proto::Burst>::create(participant));
  ENAMEL_TRY_ASSIGN(auto infos, dds::Reader<proto::DeviceInfo>::create(participant));
  ENAMEL_TRY_ASSIGN(auto statuses, dds::Reader<proto::Status>::create(participant));
  ENAMEL_TRY_ASSIGN(auto events, dds::Reader<proto::Event>::create(participant));
  ENAMEL_TRY_ASSIGN(auto replies, dds::Reader<proto::CommandReply>::create(participant));
  ENAMEL_TRY_ASSIGN(auto commands, dds::Writer<proto::Command>::create(participant));
  ENAMEL_TRY_ASSIGN(auto sync_replies, dds::Reader<proto::TimeSyncRep>::create(participant));
  ENAMEL_TRY_ASSIGN(auto sync_requests, dds::Writer<proto::TimeSyncReq>::create(participant));
  Ends ends{std::move(infos),   std::move(statuses), std::move(events),       std::move(bursts),
            std::move(replies), std::move(commands), std::move(sync_replies), std::move(sync_requests)};
  return std::unique_ptr<ProbeLink>(new ProbeLink(participant, std::move(ends), config, clock));
}

ProbeLink::ProbeLink(const dds::Participant& participant, Ends ends, const ProbeLinkConfig& config, Clock& clock)
    : config_(config),
      clock_(clock),
      participant_(participant),
      infos_(std::move(ends.infos)),
      statuses_(std::move(ends.statuses)),
      events_(std::move(ends.events)),
      bursts_(std::move(ends.bursts)),
      replies_(std::move(ends.replies)),
      commands_(std::move(ends.commands)),
      sync_replies_(std::move(ends.sync_replies)),
      sync_requests_(std::move(ends.sync_requests)) {
  const auto now = static_cast<std::uint64_t>(to_ns(clock.now()));
  if (config_.client_id == 0) config_.client_id = static_cast<std::uint32_t>(now ^ (now >> 32U)) | 1U;
  next_cmd_id_ = now;  // distinct from those of a host that ran before: the probe remembers the last replies
}

Result<std::optional<proto::DeviceInfo>> ProbeLink::find() {
  ENAMEL_TRY_ASSIGN(const auto infos, infos_.take());
  for (const auto& info : infos) {
    if (!info.valid) continue;
    std::erase_if(seen_, [&](const auto& s) { return s.serial == info.value.serial; });
    seen_.push_back(info.value);
  }
  if (!config_.serial.empty()) {
    const auto match =
        std::find_if(seen_.begin(), seen_.end(), [&](const auto& s) { return s.serial == config_.serial; });
    if (match == seen_.end()) return std::optional<proto::DeviceInfo>{};
    return take(*match);
  }
  if (seen_.size() > 1) {
    std::string serials;
    for (const auto& s : seen_) serials += (serials.empty() ? "" : ", ") + s.serial;
    return fail(ErrorCode::kProbeAmbiguous, serials);
  }
  if (seen_.empty()) return std::optional<proto::DeviceInfo>{};
  return take(seen_.front());
}

Result<std::optional<proto::DeviceInfo>> ProbeLink::take(const proto::DeviceInfo& info) {
  if (info.protocol_version != proto::kProtocolVersion) {
    return fail(ErrorCode::kProbeVersion, info.serial + " speaks protocol " + std::to_string(info.protocol_version) +
                                              ", this program " + std::to_string(proto::kProtocolVersion));
  }
  probe_ = info;
  return probe_;
}

Error ProbeLink::not_found() const {
  std::string foreign;
  for (const int major : dds::foreign_versions(participant_)) {
    foreign += (foreign.empty() ? "" : ", ") + std::to_string(major);
  }
  if (foreign.empty()) return {ErrorCode::kProbeNotFound, "none answered in time"};
  return {ErrorCode::kProbeVersion, "none answered in time, but there are programs of protocol " + foreign +
                                        "; this one speaks " + std::to_string(proto::kProtocolVersion)};
}

Result<void> ProbeLink::send(const proto::Command& command) { return commands_.write(command); }

Result<proto::CommandReply> ProbeLink::command(proto::Opcode opcode, std::array<std::int64_t, 4> args,
                                               const std::string& text) {
  if (!probe_) return fail(ErrorCode::kProbeNotFound);
  proto::Command command;
  command.probe_id = probe_->probe_id;
  command.cmd_id = next_cmd_id_++;
  command.client_id = config_.client_id;
  command.opcode = opcode;
  command.arg_i = args;
  command.arg_s = text;
  const HostTime deadline = clock_.now() + config_.command_timeout;
  while (clock_.now() < deadline) {
    ENAMEL_TRY(send(command));
    static_cast<void>(replies_.wait(config_.command_retry));
    ENAMEL_TRY_ASSIGN(const auto replies, replies_.take());
    for (const auto& reply : replies) {
      if (!reply.valid || reply.value.cmd_id != command.cmd_id || reply.value.client_id != config_.client_id) continue;
      next_renewal_ = clock_.now() + config_.lease_renewal;
      if (reply.value.status == proto::ReplyStatus::kOk) {
        if (opcode == proto::Opcode::kSessionOpen) session_open_ = true;
        if (opcode == proto::Opcode::kSessionClose) session_open_ = false;
        return reply.value;
      }
      return fail(ErrorCode::kProbeRefused, std::string(name_of(opcode)) + ": " +
                                                std::string(name_of(reply.value.status)) +
                                                (reply.value.detail.empty() ? "" : ", " + reply.value.detail));
    }
  }
  return fail(ErrorCode::kProbeLost, probe_->serial + " did not answer " + std::string(name_of(opcode)));
}

void ProbeLink::wait_data(Nanoseconds timeout) { static_cast<void>(bursts_.wait(timeout)); }

Result<LinkInput> ProbeLink::poll() {
  LinkInput input;
  ENAMEL_TRY_ASSIGN(input.bursts, bursts_.take());
  ENAMEL_TRY_ASSIGN(const auto statuses, statuses_.take());
  ENAMEL_TRY_ASSIGN(const auto events, events_.take());
  if (!probe_) return input;
  std::erase_if(input.bursts, [&](const auto& b) { return b.valid && b.value.probe_id != probe_->probe_id; });
  for (const auto& status : statuses) {
    if (!status.valid || status.value.probe_id != probe_->probe_id) continue;
    status_ = status.value;
    status_came_ = clock_.now();
    input.statuses.push_back(status.value);
  }
  for (const auto& event : events) {
    if (event.valid && event.value.probe_id == probe_->probe_id) input.events.push_back(event.value);
  }
  take_time_sync();
  keep_alive();
  return input;
}

void ProbeLink::take_time_sync() {
  const auto replies = sync_replies_.take();
  if (!replies) return;
  for (const auto& reply : *replies) {
    if (!reply.valid || reply.value.client_id != config_.client_id) continue;
    clock_map_.add(reply.value.t1_host_ns, reply.value.t2_probe_ns, reply.value.t3_probe_ns, to_ns(clock_.now()));
  }
}

// Nobody waits for the answers: a lost one is made up for by the next.
void ProbeLink::keep_alive() {
  const HostTime now = clock_.now();
  if (session_open_ && now >= next_renewal_) {
    next_renewal_ = now + config_.lease_renewal;
    proto::Command ping;
    ping.probe_id = probe_->probe_id;
    ping.cmd_id = next_cmd_id_++;
    ping.client_id = config_.client_id;
    static_cast<void>(send(ping));
  }
  if (now >= next_sync_) {
    next_sync_ = now + config_.time_sync_period;
    static_cast<void>(sync_requests_.write({probe_->probe_id, sync_seq_++, config_.client_id, to_ns(clock_.now())}));
  }
}

bool ProbeLink::alive() const {
  return statuses_.peers().alive > 0 && (!status_ || clock_.now() - status_came_ < config_.silence);
}

}  // namespace enamel::host
