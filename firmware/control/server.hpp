// Carries commands to the controller and its replies, status and events back.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "firmware/control/controller.hpp"
#include "firmware/control/heater_loop.hpp"
#include "firmware/hal/heater.hpp"
#include "firmware/hal/light.hpp"
#include "protocol/base/clock.hpp"
#include "protocol/base/result.hpp"

namespace enamel::fw {

/// The probe's end of the link. Failures are the transport's to log: the probe goes on without a host.
class ControlTransport {
 public:
  virtual ~ControlTransport() = default;
  /// Waits for commands, at most `timeout`; those for other probes are left out.
  [[nodiscard]] virtual std::vector<proto::Command> wait_commands(Nanoseconds timeout) = 0;
  virtual void send(const proto::CommandReply& reply) = 0;
  virtual void send(const proto::Status& status) = 0;
  virtual void send(const proto::Event& event) = 0;
};

struct ServerConfig {
  std::uint32_t probe_id = 0;
  std::string fw_version;
  Nanoseconds status_period{200'000'000};
  Nanoseconds poll{10'000'000};
};

/// Link figures for Status.
struct LinkRates {
  std::uint16_t burst_rate_chz = 0;
  std::uint16_t write_ms_p99 = 0;
};

/// What the server speaks for; all of it outlives the server.
struct ServedProbe {
  ProbeController& controller;
  ControlTransport& transport;
  const BurstLedger& ledger;
  const Thermal& thermal;
  const Light& light;
  std::function<LinkRates()> rates;
  Heater* heater = nullptr;  ///< null: none
};

/// One thread.
class ControlServer {
 public:
  ControlServer(ServedProbe probe, Clock& clock, const ServerConfig& config);

  /// Waits at most one poll period, then handles what came, ticks the controller and publishes what is due.
  void step();
  /// Status now, whatever its period: the last word before the program ends.
  void publish_status();
  /// Beside those of the controller.
  void publish(const Notice& notice);

 private:
  void publish_notices();
  void heat(const Temperatures& t);

  ServedProbe probe_;
  Clock& clock_;
  ServerConfig config_;
  std::uint32_t status_seq_ = 0;
  std::uint32_t event_seq_ = 0;
  HostTime next_status_{};
  HeaterLoop heater_loop_;
  std::uint16_t heater_permille_ = 0;
};

}  // namespace enamel::fw
