#include "firmware/control/controller.hpp"

#include <fmt/core.h>

#include <array>
#include <cstdlib>
#include <utility>

namespace enamel::fw {
namespace {

using proto::ProbeState;
using proto::ReplyStatus;
using proto::Severity;

constexpr std::array<Nanoseconds, 3> kRetryDelay{Nanoseconds{500'000'000}, Nanoseconds{1'000'000'000},
                                                 Nanoseconds{2'000'000'000}};

std::uint32_t fault_bit(ReplyStatus fault) {
  return std::uint32_t{1} << static_cast<unsigned>(std::abs(static_cast<int>(fault)) / 100);
}

std::uint16_t event_code(ReplyStatus fault) { return static_cast<std::uint16_t>(std::abs(static_cast<int>(fault))); }

}  // namespace

ProbeController::ProbeController(AcquisitionPort& acquisition, LightSwitch& light, BurstLedger& ledger,
                                 const ControllerConfig& config, UpdateGate* gate)
    : acquisition_(acquisition), light_(light), ledger_(ledger), config_(config), gate_(gate) {
  light_.permit(false);
}

void ProbeController::boot(HostTime now) { (void)apply(Input::kBooted, now); }

void ProbeController::shut_down() {
  light_.permit(false);
  acquisition_.abort();
}

std::vector<Notice> ProbeController::take_notices() { return std::exchange(notices_, {}); }

void ProbeController::notice(std::uint16_t code, Severity severity, std::string text) {
  notices_.push_back({code, severity, std::move(text)});
}

ProbeController::Verdict ProbeController::bad_state(Input input) const {
  return {Status::kBadState, fmt::format("{} is not possible in {}", name_of(input), proto::name_of(state_))};
}

ProbeController::Verdict ProbeController::apply(Input input, HostTime now) {
  const auto next = next_state(state_, input);
  if (!next) return bad_state(input);
  enter(*next, input, now);
  return {};
}

void ProbeController::enter(ProbeState next, Input why, HostTime now) {
  if (!light_permitted(next)) light_.permit(false);
  if (light_permitted(state_)) acquisition_.abort();  // returns at once when its job is done
  drain_.reset();
  flush_deadline_.reset();
  const bool session = next == ProbeState::kScanning || next == ProbeState::kPaused;
  if (gate_ != nullptr && !session) gate_->end_scan();
  const ProbeState left = std::exchange(state_, next);
  entered_ = now;
  notice(static_cast<std::uint16_t>(next), next == ProbeState::kSafe ? Severity::kSafety : Severity::kInfo,
         fmt::format("{} -> {}: {}", proto::name_of(left), proto::name_of(next), name_of(why)));
  light_.permit(light_permitted(next) && !is_hung());
  switch (next) {
    case ProbeState::kSelftest:
      return acquisition_.self_test();
    case ProbeState::kWarmup:
      return acquisition_.calibrate();
    case ProbeState::kScanning:
      return acquisition_.scan(session_, limit_);
    case ProbeState::kIdle:
      fault_mask_ = 0;
      return;
    case ProbeState::kReady:
      retries_ = 0;
      return;
    default:
      return;
  }
}

void ProbeController::raise(Input input, ReplyStatus fault, HostTime now) {
  if (!next_state(state_, input)) return;
  fault_mask_ |= fault_bit(fault);
  notice(event_code(fault), input == Input::kInterlock ? Severity::kSafety : Severity::kError,
         fmt::format("{} in {}", proto::name_of(fault), proto::name_of(state_)));
  (void)apply(input, now);
}

void ProbeController::tick(HostTime now, const Temperatures& temperatures) {
  watch_.update(acquisition_.report(), now);
  check_lease(now);
  follow_update(now);
  check_temperatures(temperatures, now);
  follow_acquisition(temperatures, now);
  if (state_ == ProbeState::kFault) retry_fault(now);
}

void ProbeController::check_lease(HostTime now) {
  if (!lease_ || now < lease_->expires) return;
  notice(event_code(ReplyStatus::kLeaseLost), Severity::kWarning,
         fmt::format("host {:08x} has not been heard from for {} ms", lease_->client_id,
                     config_.lease.count() / 1'000'000));
  lease_.reset();
  if (state_ == ProbeState::kScanning) (void)end_scan(Input::kLeaseLost, now);
}

std::optional<std::int16_t> ProbeController::heating() const noexcept {
  const bool used = state_ == ProbeState::kWarmup || state_ == ProbeState::kReady || state_ == ProbeState::kScanning ||
                    state_ == ProbeState::kPaused;
  return config_.has_heater && used && lease_ ? heater_set_point_cc_ : std::nullopt;
}

/// UPDATING is entered from rest only; scanning is refused in it.
void ProbeController::follow_update(HostTime now) {
  if (gate_ == nullptr) return;
  const bool resting = state_ == ProbeState::kIdle || state_ == ProbeState::kReady;
  if (resting && gate_->updating()) (void)apply(Input::kUpdate, now);
  if (state_ == ProbeState::kUpdating && !gate_->updating()) (void)apply(Input::kUpdateOver, now);
}

void ProbeController::check_temperatures(const Temperatures& t, HostTime now) {
  if (t.tip_cc && *t.tip_cc > config_.max_tip_cc) raise(Input::kInterlock, ReplyStatus::kTipOvertemp, now);
  if (t.soc_cc && *t.soc_cc > config_.max_soc_cc) raise(Input::kInterlock, ReplyStatus::kSocOvertemp, now);
}

void ProbeController::follow_acquisition(const Temperatures& t, HostTime now) {
  if (!light_permitted(state_)) return;
  const AcquisitionReport report = acquisition_.report();
  if (report.led_stuck) return raise(Input::kInterlock, ReplyStatus::kLedStuck, now);
  if (is_hung()) return raise(Input::kFault, ReplyStatus::kWatchdog, now);
  if (report.phase == AcquisitionPhase::kFailed) return raise(Input::kFault, report.fault, now);
  if (state_ == ProbeState::kScanning) return follow_scan(report, now);
  const bool measured = report.phase == AcquisitionPhase::kDone;
  if (!measured && now - entered_ > config_.measure_timeout) return raise(Input::kFault, ReplyStatus::kCamTimeout, now);
  if (state_ == ProbeState::kSelftest) {
    if (measured) (void)apply(Input::kSelfTestOk, now);
    return;
  }
  if (!t.tip_cc) return raise(Input::kFault, ReplyStatus::kThermistor, now);
  if (measured && *t.tip_cc >= config_.warm_tip_cc) {
    (void)apply(Input::kWarm, now);
  } else if (now - entered_ > config_.warmup_timeout) {
    raise(Input::kFault, ReplyStatus::kHeaterOpen, now);
  }
}

void ProbeController::follow_scan(const AcquisitionReport& report, HostTime now) {
  switch (report.phase) {
    case AcquisitionPhase::kEnded:
      return finish_source(now);
    case AcquisitionPhase::kDone:
      (void)apply(drain_ ? drain_->input : Input::kStop, now);
      return;
    default:
      if (drain_ && now >= drain_->deadline) (void)apply(drain_->input, now);  // enter() aborts what is left
      return;
  }
}

/// The session's counters are final once the publisher has sent or shed everything.
void ProbeController::finish_source(HostTime now) {
  light_.permit(false);
  if (!flush_deadline_) flush_deadline_ = now + config_.flush_timeout;
  const BurstCounts counts = ledger_.counts();
  if (counts.under_way() > 0 && now < *flush_deadline_) return;
  source_ended_ = true;
  (void)apply(Input::kSourceEnded, now);
  std::string drops;
  for (std::size_t i = 0; i < counts.dropped.size(); ++i) {
    if (counts.dropped[i] == 0) continue;
    drops += fmt::format(" {}={}", proto::name_of(static_cast<proto::DropReason>(i)), counts.dropped[i]);
  }
  notice(proto::kEventSessionEnded, Severity::kInfo,
         fmt::format("session {} ended: begun={} emitted={} dropped={}{}", counts.session.id.value, counts.begun,
                     counts.emitted, counts.dropped_total(), drops));
}

/// One that hangs still wants the light: it gets none, and is not tried again.
void ProbeController::retry_fault(HostTime now) {
  if (is_hung()) return;
  const auto n = static_cast<std::size_t>(retries_);
  if (n >= kRetryDelay.size() || now - entered_ < kRetryDelay[n]) return;
  ++retries_;
  (void)apply(Input::kRetry, now);
}

}  // namespace enamel::fw
