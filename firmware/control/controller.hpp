// The probe's behaviour: commands, lease, states, safety. Time is passed in; the acquisition and the light are ports.
//
// Invariants (property-tested): the light is on only in SCANNING, SELFTEST and WARMUP; no transition without an event;
// a command past its deadline is never executed; a repeated cmd_id never executes twice.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "firmware/acquire/acquisition_port.hpp"
#include "firmware/acquire/light_switch.hpp"
#include "firmware/acquire/silence_watch.hpp"
#include "firmware/control/probe_fsm.hpp"
#include "firmware/control/reply_cache.hpp"
#include "firmware/control/update_gate.hpp"
#include "firmware/hal/thermal.hpp"
#include "protocol/base/time.hpp"

namespace enamel::fw {

inline constexpr std::int16_t kUsualSetPointCc = 3700;  ///< of the tip: mouth warmth

struct ControllerConfig {
  /// Below the 3 s that the protocol promises: what is under way is still finished before the light goes off.
  Nanoseconds lease{2'500'000'000};
  Nanoseconds drain_timeout{450'000'000};  ///< for the burst under way: 24 ms, and what a busy machine adds
  Nanoseconds measure_timeout{10'000'000'000};
  Nanoseconds warmup_timeout{120'000'000'000};
  Nanoseconds flush_timeout{3'000'000'000};  ///< for the publisher to send what is queued when a source has ended
  std::int16_t warm_tip_cc = 3500;
  std::int16_t max_tip_cc = 4100;
  std::int16_t max_soc_cc = 9000;
  Nanoseconds max_silence{2'000'000'000};  ///< of an acquisition at work: longer, and it hangs
  bool has_heater = false;
};

struct Notice {
  std::uint16_t code = 0;
  proto::Severity severity = proto::Severity::kInfo;
  std::string text;
};

/// One thread.
class ProbeController {
 public:
  /// `gate`: null on a probe that is never updated, else outlives this.
  ProbeController(AcquisitionPort& acquisition, LightSwitch& light, BurstLedger& ledger,
                  const ControllerConfig& config = {}, UpdateGate* gate = nullptr);

  void boot(HostTime now);
  /// The reply's probe_id and t_ns are left to the caller.
  [[nodiscard]] proto::CommandReply handle(const proto::Command& command, HostTime now);
  /// Call at least every 20 ms.
  void tick(HostTime now, const Temperatures& temperatures);
  /// Set point of the tip's heater, 0.01 degC; nullopt: not to heat. Only while a host holds the probe.
  [[nodiscard]] std::optional<std::int16_t> heating() const noexcept;
  void heater_failed(proto::ReplyStatus fault, HostTime now) { raise(Input::kFault, fault, now); }
  /// Light off, acquisition stopped; for the end of the program.
  void shut_down();

  [[nodiscard]] proto::ProbeState state() const noexcept { return state_; }
  [[nodiscard]] std::uint32_t fault_mask() const noexcept { return fault_mask_; }
  [[nodiscard]] std::vector<Notice> take_notices();
  /// How long the acquisition, at work, has shown no sign of life.
  [[nodiscard]] Nanoseconds silence() const noexcept { return watch_.silence(); }
  /// A finite source was played to its end.
  [[nodiscard]] bool source_ended() const noexcept { return source_ended_; }
  /// A host has closed its session, and none is open.
  [[nodiscard]] bool session_closed() const noexcept { return session_closed_ && !lease_; }

 private:
  using Status = proto::ReplyStatus;
  struct Lease {
    std::uint32_t client_id = 0;
    HostTime expires{};
  };
  struct Verdict {
    Status status = Status::kOk;
    std::string detail;
  };
  struct Drain {
    Input input = Input::kPause;
    HostTime deadline{};
  };

  [[nodiscard]] Verdict execute(const proto::Command& command, HostTime now);
  [[nodiscard]] Verdict open_session(const proto::Command& command, HostTime now);
  [[nodiscard]] Verdict close_session(HostTime now);
  [[nodiscard]] Verdict start_scan(const proto::Command& command, HostTime now);
  [[nodiscard]] Verdict set_heater(const proto::Command& command);
  [[nodiscard]] Verdict set_exposure(const proto::Command& command);
  [[nodiscard]] Verdict end_scan(Input input, HostTime now);
  [[nodiscard]] Verdict apply(Input input, HostTime now);
  [[nodiscard]] Verdict bad_state(Input input) const;
  void enter(proto::ProbeState next, Input why, HostTime now);
  void raise(Input input, Status fault, HostTime now);
  void notice(std::uint16_t code, proto::Severity severity, std::string text);

  [[nodiscard]] bool is_hung() const noexcept { return watch_.silence() > config_.max_silence; }
  void check_lease(HostTime now);
  void follow_update(HostTime now);
  void check_temperatures(const Temperatures& t, HostTime now);
  void follow_acquisition(const Temperatures& t, HostTime now);
  void follow_scan(const AcquisitionReport& report, HostTime now);
  void finish_source(HostTime now);
  void retry_fault(HostTime now);

  AcquisitionPort& acquisition_;
  LightSwitch& light_;
  BurstLedger& ledger_;
  ControllerConfig config_;
  UpdateGate* gate_;
  proto::ProbeState state_ = proto::ProbeState::kBoot;
  HostTime entered_{};
  std::optional<Lease> lease_;
  std::optional<Drain> drain_;
  std::optional<HostTime> flush_deadline_;
  std::optional<std::uint64_t> limit_;
  ScanTag session_;
  std::uint32_t session_client_ = 0;
  bool session_closed_ = false;
  bool source_ended_ = false;
  int retries_ = 0;
  SilenceWatch watch_;
  std::optional<std::int16_t> heater_set_point_cc_ = kUsualSetPointCc;
  std::uint32_t fault_mask_ = 0;
  ReplyCache replies_;
  std::vector<Notice> notices_;
};

}  // namespace enamel::fw
