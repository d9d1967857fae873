// The control link over DDS, and the clock exchange beside it.
#pragma once

#include <memory>
#include <thread>

#include "firmware/control/server.hpp"
#include "protocol/dds/participant.hpp"
#include "protocol/dds/topics.hpp"

namespace enamel::fw {

/// One thread, that of the ControlServer.
class DdsTransport final : public ControlTransport {
 public:
  /// Publishes `info` at once. Errors: kDds, kMessageInvalid.
  [[nodiscard]] static Result<std::unique_ptr<DdsTransport>> create(const dds::Participant& participant,
                                                                    const proto::DeviceInfo& info);

  [[nodiscard]] std::vector<proto::Command> wait_commands(Nanoseconds timeout) override;
  void send(const proto::CommandReply& reply) override;
  void send(const proto::Status& status) override;
  void send(const proto::Event& event) override;
  /// Gives a reader time to take the last words.
  void flush(Nanoseconds timeout);

 private:
  struct Ends {
    dds::Reader<proto::Command> commands;
    dds::Writer<proto::CommandReply> replies;
    dds::Writer<proto::Status> statuses;
    dds::Writer<proto::Event> events;
    dds::Writer<proto::DeviceInfo> infos;
  };
  DdsTransport(Ends ends, std::uint32_t probe_id) : ends_(std::move(ends)), probe_id_(probe_id) {}

  Ends ends_;
  std::uint32_t probe_id_;
};

/// Answers clock exchanges from a thread of its own, so that the answer does not wait for anything.
class TimeSyncServer {
 public:
  /// Errors: kDds.
  [[nodiscard]] static Result<std::unique_ptr<TimeSyncServer>> create(const dds::Participant& participant,
                                                                      std::uint32_t probe_id, Clock& clock);
  ~TimeSyncServer();

 private:
  TimeSyncServer(dds::Reader<proto::TimeSyncReq> requests, dds::Writer<proto::TimeSyncRep> replies,
                 std::uint32_t probe_id, Clock& clock);
  void run(const std::stop_token& stop);

  dds::Reader<proto::TimeSyncReq> requests_;
  dds::Writer<proto::TimeSyncRep> replies_;
  std::uint32_t probe_id_;
  Clock& clock_;
  std::jthread thread_;  ///< last member: stops before the others go
};

}  // namespace enamel::fw
