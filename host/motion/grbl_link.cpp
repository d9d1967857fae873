#include "host/motion/grbl_link.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host/motion/grbl_text.hpp"

namespace enamel::motion {
namespace {

using std::chrono::milliseconds;

constexpr int kMostDrained = 100;  // chosen: a buffer of GRBL holds five answers; each is waited for by 20 ms
constexpr Nanoseconds kAskEvery = milliseconds(50);      // reports while something runs: GRBL takes 10 a second easily
constexpr Nanoseconds kWriteWithin = milliseconds(500);  // 80 bytes take 7 ms
constexpr Nanoseconds kStandWithin = milliseconds(1200);
constexpr Nanoseconds kRestartWithin = milliseconds(1200);
constexpr int kMostGarbled = 3;
constexpr std::string_view kSoftReset = "\x18";

tl::unexpected<Error> unusable(std::string text) { return fail(ErrorCode::kAxes, std::move(text)); }

}  // namespace

Result<std::unique_ptr<GrblLink>> GrblLink::open(const std::string& path, Nanoseconds banner_within, Clock& clock) {
  ENAMEL_TRY_ASSIGN(SerialPort port, SerialPort::open(path, clock));
  std::unique_ptr<GrblLink> link(new GrblLink(std::move(port), clock));
  ENAMEL_TRY(link->greet(banner_within));
  return link;
}

Result<bool> GrblLink::await_banner(Nanoseconds within, std::string& heard) {
  const HostTime deadline = clock_.now() + within;
  while (clock_.now() < deadline) {
    ENAMEL_TRY_ASSIGN(const auto line, port_.read_line(deadline));
    if (!line) continue;
    const GrblReply reply = parse_reply(*line);
    if (const auto* banner = std::get_if<GrblBanner>(&reply)) {
      version_ = banner->version;
      return true;
    }
    if (const auto* garbled = std::get_if<GrblGarbled>(&reply); garbled != nullptr && heard.empty()) {
      heard = garbled->text;
    }
  }
  return false;
}

Result<void> GrblLink::greet(Nanoseconds banner_within) {
  std::string heard;
  ENAMEL_TRY_ASSIGN(bool has_banner, await_banner(banner_within, heard));
  // Readable words of something else: nothing is sent to a device that is not ours. Noise of the start may hide a
  // banner.
  const bool is_readable = !heard.empty() && heard.find('?') == std::string::npos;
  if (!has_banner && !is_readable) {
    ENAMEL_TRY(send(kSoftReset));
    ENAMEL_TRY_ASSIGN(has_banner, await_banner(kRestartWithin, heard));
  }
  if (!has_banner && !heard.empty()) {
    return unusable(
        fmt::format("no GRBL controller: it says '{}': give the port of the axes, or check baud rate (115200) and "
                    "cable",
                    heard));
  }
  if (!has_banner)
    return unusable("the controller does not answer: check its supply, the cable and that GRBL 1.1 is flashed");
  if (version_.starts_with("1.1")) return drain();
  return unusable(fmt::format("the controller runs Grbl {}, this program speaks 1.1: flash Grbl 1.1h", version_));
}

Result<void> GrblLink::send(std::string_view bytes) { return port_.write(bytes, clock_.now() + kWriteWithin); }

Result<std::optional<GrblReply>> GrblLink::next(HostTime until) {
  ENAMEL_TRY_ASSIGN(const auto line, port_.read_line(until));
  if (!line) return std::optional<GrblReply>{};
  GrblReply reply = parse_reply(*line);
  if (const auto* alarm = std::get_if<GrblAlarm>(&reply)) return fail(ErrorCode::kAxesAlarm, alarm_text(alarm->number));
  if (const auto* error = std::get_if<GrblError>(&reply)) return unusable(error_text(error->number));
  if (std::holds_alternative<GrblBanner>(reply)) {
    return fail(ErrorCode::kAxesAlarm,
                "the controller restarted by itself, the position is lost: check supply and cable, home again");
  }
  if (const auto* garbled = std::get_if<GrblGarbled>(&reply); garbled != nullptr && ++garbled_ >= kMostGarbled) {
    return unusable(fmt::format(
        "the line is disturbed, last '{}': shorter or shielded cable, away from the motors' wires", garbled->text));
  }
  return std::optional(std::move(reply));
}

Result<void> GrblLink::drain() {
  // A controller that never falls silent shall not hold us here. On a machine that lets us wait the time alone says
  // nothing: a few lines that came meanwhile are no torrent.
  const HostTime deadline = clock_.now() + kRestartWithin;
  for (int lines = 0; lines < kMostDrained || clock_.now() < deadline; ++lines) {
    ENAMEL_TRY_ASSIGN(const auto reply, next(clock_.now() + milliseconds(20)));
    if (!reply) return {};
  }
  return unusable("the controller does not stop talking: another device, or a program running on it");
}

Result<void> GrblLink::command(const std::string& line, const GrblWait& wait) {
  const HostTime deadline = clock_.now() + wait.within;
  garbled_ = 0;
  ENAMEL_TRY(send(line + "\n"));
  HostTime heard = clock_.now();
  HostTime ask = heard + kAskEvery;
  while (clock_.now() < deadline) {
    if (wait.cancel != nullptr && wait.cancel->load()) return fail(ErrorCode::kCancelled, "axes");
    if (wait.silence > Nanoseconds{0} && clock_.now() >= ask) {
      ENAMEL_TRY(send("?"));
      ask = clock_.now() + kAskEvery;
    }
    ENAMEL_TRY_ASSIGN(const auto reply, next(std::min(clock_.now() + kAskEvery, deadline)));
    if (reply) {
      heard = clock_.now();
      if (std::holds_alternative<GrblOk>(*reply)) return {};
      const auto* status = std::get_if<GrblStatus>(&*reply);
      if (status != nullptr && wait.watch) ENAMEL_TRY(wait.watch(*status));
    }
    if (wait.silence > Nanoseconds{0} && clock_.now() - heard > wait.silence) {
      return unusable(fmt::format("the controller fell silent after '{}': check supply and cable, home again", line));
    }
  }
  return unusable(
      fmt::format("no `ok` to '{}' in time: the axis moves slower than expected, or an answer was lost", line));
}

Result<GrblStatus> GrblLink::status(Nanoseconds within) {
  const HostTime deadline = clock_.now() + within;
  garbled_ = 0;
  ENAMEL_TRY(drain());
  while (clock_.now() < deadline) {
    ENAMEL_TRY(send("?"));
    const HostTime again = std::min(clock_.now() + 4 * kAskEvery, deadline);
    while (clock_.now() < again) {
      ENAMEL_TRY_ASSIGN(const auto reply, next(again));
      const auto* status = reply ? std::get_if<GrblStatus>(&*reply) : nullptr;
      if (status != nullptr) return *status;
    }
  }
  return unusable("the controller answers no status request: check supply and cable, home again");
}

Result<GrblSettings> GrblLink::settings(Nanoseconds within) {
  const HostTime deadline = clock_.now() + within;
  garbled_ = 0;
  ENAMEL_TRY(send("$$\n"));
  GrblSettings settings;
  while (clock_.now() < deadline) {
    ENAMEL_TRY_ASSIGN(const auto reply, next(deadline));
    if (!reply) continue;
    if (std::holds_alternative<GrblOk>(*reply)) return settings;
    if (const auto* s = std::get_if<GrblSetting>(&*reply)) settings[s->number] = s->value;
  }
  return unusable("the controller does not list its settings ($$): check cable and firmware");
}

bool GrblLink::slow_down() {
  const HostTime deadline = clock_.now() + kStandWithin;
  if (!send("!")) return false;
  while (clock_.now() < deadline) {
    if (!send("?")) return false;
    const HostTime again = std::min(clock_.now() + kAskEvery, deadline);
    while (clock_.now() < again) {
      const auto reply = next(again);
      if (!reply) return false;  // alarm or restart: it stands, but nobody knows where
      const auto* status = *reply ? std::get_if<GrblStatus>(&**reply) : nullptr;
      if (status == nullptr) continue;
      if (status->state == GrblState::kIdle || (status->state == GrblState::kHold && status->sub == 0)) return true;
      if (status->state == GrblState::kAlarm) return false;
    }
  }
  return false;
}

Result<bool> GrblLink::halt() {
  garbled_ = 0;
  const bool stands = slow_down();
  ENAMEL_TRY(reset());
  if (!stands) return false;
  ENAMEL_TRY_ASSIGN(const GrblStatus now, status(4 * kAskEvery));
  return now.state == GrblState::kIdle;
}

Result<void> GrblLink::reset() {
  garbled_ = 0;
  ENAMEL_TRY(send(kSoftReset));
  std::string heard;
  ENAMEL_TRY_ASSIGN(const bool has_banner, await_banner(kRestartWithin, heard));
  if (has_banner) return {};
  return unusable("the controller does not answer the reset: switch the motors' supply off, then home");
}

}  // namespace enamel::motion
