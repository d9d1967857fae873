// What a host asks of the probe: sessions, scans, the heater.
#include <fmt/core.h>

#include <cmath>
#include <limits>

#include "firmware/control/controller.hpp"
#include "firmware/control/heater_loop.hpp"

namespace enamel::fw {

using proto::Opcode;
using proto::ProbeState;

proto::CommandReply ProbeController::handle(const proto::Command& command, HostTime now) {
  if (lease_ && lease_->client_id == command.client_id) lease_->expires = now + config_.lease;
  if (const auto* earlier = replies_.find(command.client_id, command.cmd_id)) return *earlier;
  Verdict verdict;
  if (command.deadline_ns != 0 && to_ns(now) > 0 && static_cast<std::uint64_t>(to_ns(now)) > command.deadline_ns) {
    verdict = {Status::kExpired, "deadline passed before the command was taken"};
  } else {
    verdict = execute(command, now);
  }
  proto::CommandReply reply;
  reply.cmd_id = command.cmd_id;
  reply.client_id = command.client_id;
  reply.status = verdict.status;
  reply.detail = proto::clip_text(verdict.detail, 256);
  replies_.add(reply);
  return reply;
}

ProbeController::Verdict ProbeController::execute(const proto::Command& command, HostTime now) {
  switch (command.opcode) {
    case Opcode::kPing:
      return {};
    case Opcode::kSafeOff:
      return state_ == ProbeState::kSafe ? Verdict{} : apply(Input::kSafeOff, now);
    case Opcode::kSessionOpen:
      return open_session(command, now);
    default:
      break;
  }
  if (!lease_ || lease_->client_id != command.client_id) {
    return {Status::kNotOwner, lease_ ? "another host holds the probe" : "open a session first"};
  }
  switch (command.opcode) {
    case Opcode::kSessionClose:
      return close_session(now);
    case Opcode::kWarmup:
      return state_ == ProbeState::kWarmup ? Verdict{} : apply(Input::kCmdWarmup, now);
    case Opcode::kScanStart:
    case Opcode::kSingleBurst:
      return start_scan(command, now);
    case Opcode::kScanPause:
      return end_scan(Input::kPause, now);
    case Opcode::kScanStop:
      return end_scan(Input::kStop, now);
    case Opcode::kSetHeater:
      return set_heater(command);
    case Opcode::kSetExposure:
      return set_exposure(command);
    case Opcode::kSelftest:
      return state_ == ProbeState::kSelftest ? Verdict{} : apply(Input::kCmdSelfTest, now);
    default:
      return {Status::kUnknownOp, fmt::format("{} is not in this firmware", proto::name_of(command.opcode))};
  }
}

ProbeController::Verdict ProbeController::open_session(const proto::Command& command, HostTime now) {
  if (lease_ && lease_->client_id != command.client_id) return {Status::kBusy, "another host holds the probe"};
  lease_ = Lease{command.client_id, now + config_.lease};
  session_closed_ = false;
  // What another host asked for ends with it; a camera that cannot change it has its own.
  static_cast<void>(acquisition_.set_exposure(0));
  return {};
}

ProbeController::Verdict ProbeController::close_session(HostTime now) {
  if (state_ == ProbeState::kScanning) (void)end_scan(Input::kStop, now);
  if (state_ == ProbeState::kPaused) (void)apply(Input::kStop, now);
  lease_.reset();
  session_closed_ = true;
  return {};
}

ProbeController::Verdict ProbeController::start_scan(const proto::Command& command, HostTime now) {
  const bool counted = command.opcode == Opcode::kSingleBurst;
  const std::int64_t arg = command.arg_i[0];
  const std::int64_t max = counted ? 1000 : std::int64_t{std::numeric_limits<std::uint32_t>::max()};
  if (arg < 1 || arg > max) {
    return {Status::kBadArg, fmt::format("{} {}: must be from 1 to {}", counted ? "burst count" : "session", arg, max)};
  }
  if (state_ == ProbeState::kScanning) {
    if (drain_) return {Status::kBusy, "the scan is just ending"};
    return counted || session_.id.value != static_cast<std::uint32_t>(arg) ? bad_state(Input::kCmdStart) : Verdict{};
  }
  if (!next_state(state_, Input::kCmdStart)) return bad_state(Input::kCmdStart);
  if (gate_ != nullptr && !gate_->begin_scan()) return {Status::kBusy, "firmware is being written"};
  if (!counted) {
    const SessionId id{static_cast<std::uint32_t>(arg)};
    if (session_.epoch == 0 || session_.id != id || session_client_ != command.client_id) {
      session_ = {id, session_.epoch + 1};
      session_client_ = command.client_id;
    }
  }
  limit_ = counted ? std::optional(static_cast<std::uint64_t>(arg)) : std::nullopt;
  source_ended_ = false;
  ledger_.open(session_);
  return apply(Input::kCmdStart, now);
}

ProbeController::Verdict ProbeController::set_heater(const proto::Command& command) {
  if (!config_.has_heater) return {Status::kUnknownOp, "this probe has no heater"};
  const double set_point = command.arg_f[0];
  if (command.arg_i[0] == 0) {
    heater_set_point_cc_.reset();
    return {};
  }
  const double most = 0.01 * HeaterLoop::kMaxSetpointCc;
  if (!(set_point >= 0) || set_point > most) {
    return {Status::kBadArg, fmt::format("heater at {:.1f} degC: must be from 0 to {:.0f}", set_point, most)};
  }
  heater_set_point_cc_ = static_cast<std::int16_t>(std::lround(100 * set_point));
  return {};
}

ProbeController::Verdict ProbeController::set_exposure(const proto::Command& command) {
  const std::int64_t us = command.arg_i[0];
  if (us < 0 || us > std::int64_t{std::numeric_limits<std::uint32_t>::max()}) {
    return {Status::kBadArg, fmt::format("exposure of {} us", us)};
  }
  const auto set = acquisition_.set_exposure(static_cast<std::uint32_t>(us));
  if (set) return {};
  return {set.error().code == ErrorCode::kConfigValue ? Status::kBadArg : Status::kUnknownOp, set.error().detail};
}

/// The burst under way is finished first: a pause loses nothing.
ProbeController::Verdict ProbeController::end_scan(Input input, HostTime now) {
  if (state_ != ProbeState::kScanning) {
    const bool there = input == Input::kPause ? state_ == ProbeState::kPaused : state_ == ProbeState::kReady;
    return there ? Verdict{} : apply(input, now);
  }
  if (drain_) {
    if (input == Input::kStop) drain_->input = input;
    return {};
  }
  acquisition_.drain();
  drain_ = Drain{input, now + config_.drain_timeout};
  return {};
}

}  // namespace enamel::fw
