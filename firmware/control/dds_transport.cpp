#include "firmware/control/dds_transport.hpp"

#include <pthread.h>

#include <utility>

#include "protocol/base/log.hpp"

namespace enamel::fw {
namespace {

constexpr Nanoseconds kSyncWait{200'000'000};

void log_failure(const char* what, const Result<void>& result) {
  if (!result) log::warn("control", "{} not sent: {}", what, result.error().message());
}

}  // namespace

Result<std::unique_ptr<DdsTransport>> DdsTransport::create(const dds::Participant& participant,
                                                           const proto::DeviceInfo& info) {
  ENAMEL_TRY_ASSIGN(auto commands, dds::Reader<proto::Command>::create(participant));
  ENAMEL_TRY_ASSIGN(auto replies, dds::Writer<proto::CommandReply>::create(participant));
  ENAMEL_TRY_ASSIGN(auto statuses, dds::Writer<proto::Status>::create(participant));
  ENAMEL_TRY_ASSIGN(auto events, dds::Writer<proto::Event>::create(participant));
  ENAMEL_TRY_ASSIGN(auto infos, dds::Writer<proto::DeviceInfo>::create(participant));
  ENAMEL_TRY(infos.write(info));
  Ends ends{std::move(commands), std::move(replies), std::move(statuses), std::move(events), std::move(infos)};
  return std::unique_ptr<DdsTransport>(new DdsTransport(std::move(ends), info.probe_id));
}

std::vector<proto::Command> DdsTransport::wait_commands(Nanoseconds timeout) {
  std::vector<proto::Command> ours;
  (void)ends_.commands.wait(timeout);
  auto taken = ends_.commands.take();
  if (!taken) {
    log::warn("control", "commands: {}", taken.error().message());
    return ours;
  }
  for (auto& received : *taken) {
    if (received.valid && received.value.probe_id == probe_id_) ours.push_back(std::move(received.value));
  }
  return ours;
}

void DdsTransport::send(const proto::CommandReply& reply) { log_failure("reply", ends_.replies.write(reply)); }
void DdsTransport::send(const proto::Status& status) { log_failure("status", ends_.statuses.write(status)); }
void DdsTransport::send(const proto::Event& event) { log_failure("event", ends_.events.write(event)); }

void DdsTransport::flush(Nanoseconds timeout) {
  (void)ends_.statuses.wait_acknowledged(timeout);
  (void)ends_.events.wait_acknowledged(timeout);
}

Result<std::unique_ptr<TimeSyncServer>> TimeSyncServer::create(const dds::Participant& participant,
                                                               std::uint32_t probe_id, Clock& clock) {
  ENAMEL_TRY_ASSIGN(auto requests, dds::Reader<proto::TimeSyncReq>::create(participant));
  ENAMEL_TRY_ASSIGN(auto replies, dds::Writer<proto::TimeSyncRep>::create(participant));
  return std::unique_ptr<TimeSyncServer>(new TimeSyncServer(std::move(requests), std::move(replies), probe_id, clock));
}

TimeSyncServer::TimeSyncServer(dds::Reader<proto::TimeSyncReq> requests, dds::Writer<proto::TimeSyncRep> replies,
                               std::uint32_t probe_id, Clock& clock)
    : requests_(std::move(requests)), replies_(std::move(replies)), probe_id_(probe_id), clock_(clock) {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  (void)pthread_setname_np(thread_.native_handle(), "fw-timesync");
}

TimeSyncServer::~TimeSyncServer() {
  thread_.request_stop();
  requests_.wake();
}

void TimeSyncServer::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    if (requests_.wait(kSyncWait) != dds::Wake::kData) continue;
    const std::int64_t t2 = to_ns(clock_.now());
    const auto taken = requests_.take();
    if (!taken) continue;
    for (const auto& r : *taken) {
      if (!r.valid || r.value.probe_id != probe_id_) continue;
      const proto::TimeSyncReq& q = r.value;
      log_failure("clock", replies_.write({probe_id_, q.seq, q.client_id, q.t1_host_ns, t2, to_ns(clock_.now())}));
    }
  }
}

}  // namespace enamel::fw
