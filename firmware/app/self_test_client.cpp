#include "firmware/app/self_test_client.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <chrono>
#include <utility>

#include "protocol/base/clock.hpp"
#include "protocol/dds/participant.hpp"
#include "protocol/dds/topics.hpp"

namespace enamel::fw {
namespace {

using proto::ProbeState;
using namespace std::chrono_literals;

constexpr double kPatienceS = 60;
constexpr Nanoseconds kRepeat = 200ms, kLook = 10ms;

class Client {
 public:
  struct Ends {
    dds::Reader<proto::DeviceInfo> infos;
    dds::Reader<proto::Status> statuses;
    dds::Reader<proto::CommandReply> replies;
    dds::Writer<proto::Command> commands;
  };
  Client(Ends ends, const ProbeOptions& options, const std::atomic<bool>& stop)
      : ends_(std::move(ends)), serial_(options.serial), stop_(&stop) {
    deadline_ = clock_.now() + std::chrono::duration_cast<Nanoseconds>(
                                   std::chrono::duration<double>(options.seconds.value_or(kPatienceS)));
  }

  Result<int> run() {
    ENAMEL_TRY(find());
    ENAMEL_TRY(wait_rest());
    ENAMEL_TRY(command(proto::Opcode::kSessionOpen));
    const Result<void> passed = test();
    const Result<void> closed = command(proto::Opcode::kSessionClose);
    ENAMEL_TRY(passed);
    ENAMEL_TRY(closed);
    return 0;
  }

 private:
  [[nodiscard]] bool in_time() const { return clock_.now() < deadline_ && !*stop_; }
  [[nodiscard]] tl::unexpected<Error> out_of_time(ErrorCode code, const std::string& detail) const {
    return *stop_ ? fail(ErrorCode::kCancelled) : fail(code, detail);
  }

  Result<void> find() {
    for (; in_time(); clock_.sleep_for(kLook)) {
      ENAMEL_TRY_ASSIGN(const auto infos, ends_.infos.take());
      for (const auto& info : infos) {
        if (!info.valid || (!serial_.empty() && info.value.serial != serial_)) continue;
        if (probe_id_ != 0 && probe_id_ != info.value.probe_id) return fail(ErrorCode::kProbeAmbiguous, "--serial");
        probe_id_ = info.value.probe_id;
      }
      if (probe_id_ != 0 && ends_.commands.peers().matched > 0) return {};
    }
    return out_of_time(ErrorCode::kProbeNotFound, serial_.empty() ? "on this probe" : serial_);
  }

  /// The newest status that is younger than `after` (device clock, ns).
  Result<std::optional<proto::Status>> status(std::uint64_t after) {
    ENAMEL_TRY_ASSIGN(const auto statuses, ends_.statuses.take());
    std::optional<proto::Status> newest;
    for (const auto& s : statuses) {
      if (s.valid && s.value.probe_id == probe_id_ && s.value.t_ns > after) newest = s.value;
    }
    return newest;
  }

  /// It may be starting; what a person uses is left alone.
  Result<void> wait_rest() {
    for (; in_time(); clock_.sleep_for(kLook)) {
      ENAMEL_TRY_ASSIGN(const auto now, status(0));
      if (!now) continue;
      if (now->state == ProbeState::kIdle || now->state == ProbeState::kReady) return {};
      if (now->state == ProbeState::kSafe) return fail(ErrorCode::kHal, "the probe is in SAFE");
      const bool used = now->state == ProbeState::kScanning || now->state == ProbeState::kPaused ||
                        now->state == ProbeState::kUpdating;
      if (used) return fail(ErrorCode::kProbeRefused, std::string(name_of(now->state)));
    }
    return out_of_time(ErrorCode::kProbeLost, "it did not come to rest");
  }

  Result<void> command(proto::Opcode opcode) {
    proto::Command c;
    c.probe_id = probe_id_;
    c.client_id = static_cast<std::uint32_t>(getpid()) | 0x8000'0000U;  // of no host's making
    c.cmd_id = static_cast<std::uint64_t>(to_ns(clock_.now()));
    c.opcode = opcode;
    while (in_time()) {
      ENAMEL_TRY(ends_.commands.write(c));
      static_cast<void>(ends_.replies.wait(kRepeat));
      ENAMEL_TRY_ASSIGN(const auto replies, ends_.replies.take());
      for (const auto& r : replies) {
        if (!r.valid || r.value.cmd_id != c.cmd_id || r.value.client_id != c.client_id) continue;
        answered_ns_ = r.value.t_ns;
        if (r.value.status == proto::ReplyStatus::kOk) return {};
        return fail(ErrorCode::kProbeRefused, fmt::format("{}: {}", name_of(opcode), r.value.detail));
      }
    }
    return out_of_time(ErrorCode::kProbeLost, std::string(name_of(opcode)));
  }

  Result<void> test() {
    ENAMEL_TRY(command(proto::Opcode::kSelftest));
    for (; in_time(); clock_.sleep_for(kLook)) {
      ENAMEL_TRY_ASSIGN(const auto now, status(answered_ns_));
      if (!now || now->state == ProbeState::kSelftest) continue;
      if (now->state == ProbeState::kIdle) return {};
      return fail(ErrorCode::kHal, fmt::format("{}, fault mask {:#x}", name_of(now->state), now->fault_mask));
    }
    return out_of_time(ErrorCode::kProbeLost, "SELFTEST did not end");
  }

  Ends ends_;
  std::string serial_;
  const std::atomic<bool>* stop_;
  mutable SteadyClock clock_;
  HostTime deadline_{};
  std::uint32_t probe_id_ = 0;
  std::uint64_t answered_ns_ = 0;
};

}  // namespace

Result<int> ask_self_test(const ProbeOptions& options, const std::atomic<bool>& stop) {
  ENAMEL_TRY_ASSIGN(const auto participant, dds::Participant::create(options.link));
  ENAMEL_TRY_ASSIGN(auto infos, dds::Reader<proto::DeviceInfo>::create(participant));
  ENAMEL_TRY_ASSIGN(auto statuses, dds::Reader<proto::Status>::create(participant));
  ENAMEL_TRY_ASSIGN(auto replies, dds::Reader<proto::CommandReply>::create(participant));
  ENAMEL_TRY_ASSIGN(auto commands, dds::Writer<proto::Command>::create(participant));
  Client client({std::move(infos), std::move(statuses), std::move(replies), std::move(commands)}, options, stop);
  return client.run();
}

}  // namespace enamel::fw
