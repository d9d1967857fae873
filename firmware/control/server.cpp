#include "firmware/control/server.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "protocol/base/log.hpp"

namespace enamel::fw {
namespace {

std::uint32_t counter(std::uint64_t n) {
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(n, std::numeric_limits<std::uint32_t>::max()));
}

std::uint64_t stamp(HostTime t) { return static_cast<std::uint64_t>(std::max<std::int64_t>(0, to_ns(t))); }

}  // namespace

ControlServer::ControlServer(ServedProbe probe, Clock& clock, const ServerConfig& config)
    : probe_(std::move(probe)), clock_(clock), config_(config) {}

void ControlServer::step() {
  const std::vector<proto::Command> commands = probe_.transport.wait_commands(config_.poll);
  for (const proto::Command& command : commands) {
    proto::CommandReply reply = probe_.controller.handle(command, clock_.now());
    reply.probe_id = config_.probe_id;
    reply.t_ns = stamp(clock_.now());
    probe_.transport.send(reply);
  }
  const Temperatures temperatures = probe_.thermal.read();
  probe_.controller.tick(clock_.now(), temperatures);
  heat(temperatures);
  publish_notices();
  if (clock_.now() >= next_status_) publish_status();
}

void ControlServer::heat(const Temperatures& t) {
  if (probe_.heater == nullptr) return;
  heater_permille_ = heater_loop_.step(probe_.controller.heating(), t.tip_cc, clock_.now());
  probe_.heater->set_power(heater_permille_);
  if (const auto fault = heater_loop_.fault()) probe_.controller.heater_failed(*fault, clock_.now());
}

/// Status goes first: who reads of a change finds the counters that belong to it.
void ControlServer::publish_notices() {
  const std::vector<Notice> notices = probe_.controller.take_notices();
  if (notices.empty()) return;
  publish_status();
  for (const Notice& n : notices) publish(n);
}

void ControlServer::publish(const Notice& notice) {
  const log::Level level = notice.severity == proto::Severity::kInfo ? log::Level::kInfo : log::Level::kWarn;
  log::at(level, "probe", "{}", notice.text);
  proto::Event event;
  event.probe_id = config_.probe_id;
  event.seq = event_seq_++;
  event.t_ns = stamp(clock_.now());
  event.code = notice.code;
  event.severity = notice.severity;
  event.text = proto::clip_text(notice.text, 200);
  probe_.transport.send(event);
}

void ControlServer::publish_status() {
  const BurstCounts counts = probe_.ledger.counts();
  const Temperatures t = probe_.thermal.read();
  const LinkRates rates = probe_.rates();
  proto::Status s;
  s.probe_id = config_.probe_id;
  s.seq = status_seq_++;
  s.t_ns = stamp(clock_.now());
  s.state = probe_.controller.state();
  s.fault_mask = probe_.controller.fault_mask();
  s.bursts_emitted = counter(counts.emitted);
  for (std::size_t i = 0; i < s.dropped.size(); ++i) s.dropped[i] = counter(counts.dropped[i]);
  s.write_ms_p99 = rates.write_ms_p99;
  s.burst_rate_chz = rates.burst_rate_chz;
  s.temp_tip_cc = t.tip_cc.value_or(std::numeric_limits<std::int16_t>::min());
  s.temp_led_cc = t.led_cc.value_or(std::numeric_limits<std::int16_t>::min());
  s.temp_soc_cc = t.soc_cc.value_or(std::numeric_limits<std::int16_t>::min());
  s.led_ma = static_cast<std::uint16_t>(std::clamp(probe_.light.sensed_ma(), 0, 65535));
  s.heater_permille = heater_permille_;
  s.fw_version = proto::clip_text(config_.fw_version, 32);
  s.session_id = counts.session.id.value;
  s.bursts_begun = counter(counts.begun);
  probe_.transport.send(s);
  next_status_ = clock_.now() + config_.status_period;
}

}  // namespace enamel::fw
