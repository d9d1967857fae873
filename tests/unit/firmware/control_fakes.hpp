// Ports of the controller that do as a test says.
#pragma once

#include "firmware/acquire/acquisition_port.hpp"
#include "firmware/acquire/light_switch.hpp"
#include "firmware/control/controller.hpp"

namespace enamel::fw::test {

class FakeLamp final : public Light {
 public:
  void set_enabled(bool on) noexcept override { on_ = on; }
  [[nodiscard]] bool enabled() const noexcept override { return on_; }
  [[nodiscard]] int sensed_ma() const noexcept override { return on_ ? 400 : 0; }

 private:
  bool on_ = false;
};

/// Wants the light whenever it works, as the real one does.
class FakeAcquisition final : public AcquisitionPort {
 public:
  explicit FakeAcquisition(LightSwitch& light) : light_(light) {}
  void scan(ScanTag session, std::optional<std::uint64_t> limit) override {
    ++scans;
    last_session = session;
    last_limit = limit;
    run();
  }
  void self_test() override { run(); }
  void calibrate() override { run(); }
  void drain() override {
    ++drains;
    if (drains_at_once) end(AcquisitionPhase::kDone);
  }
  void abort() override {
    if (now.phase == AcquisitionPhase::kRunning && !hangs) end(AcquisitionPhase::kDone);
  }
  [[nodiscard]] AcquisitionReport report() const override {
    AcquisitionReport report = now;
    report.beats = hangs ? beats_ : ++beats_;
    return report;
  }

  [[nodiscard]] Result<void> set_exposure(std::uint32_t exposure_us) override {
    if (exposure_us > 3800) return fail(ErrorCode::kConfigValue, "must be up to 3800");
    if (is_fixed && exposure_us != 0) return fail(ErrorCode::kHal, "bound to the pattern");
    exposure = exposure_us;
    return {};
  }

  void end(AcquisitionPhase phase, proto::ReplyStatus fault = proto::ReplyStatus::kOk, bool stuck = false) {
    now = {phase, fault, stuck};
    light_.want(false);
  }
  AcquisitionReport now;
  ScanTag last_session;
  std::optional<std::uint64_t> last_limit;
  int scans = 0;
  std::uint32_t exposure = 0;
  bool is_fixed = false;  ///< it cannot be changed
  int drains = 0;
  bool drains_at_once = true;
  bool hangs = false;  ///< in a driver, with the light wanted

 private:
  void run() {
    now = {AcquisitionPhase::kRunning, proto::ReplyStatus::kOk, false};
    light_.want(true);
  }
  LightSwitch& light_;
  mutable std::uint64_t beats_ = 0;
};

class FakeGate final : public UpdateGate {
 public:
  [[nodiscard]] bool begin_scan() noexcept override { return scan_open = !update; }
  void end_scan() noexcept override { scan_open = false; }
  [[nodiscard]] bool updating() const noexcept override { return update; }
  bool update = false;
  bool scan_open = false;
};

struct ControlRig {
  explicit ControlRig(const ControllerConfig& its_config = {}) : config(its_config) {}
  ControllerConfig config;
  FakeLamp lamp;
  LightSwitch light{lamp};
  FakeAcquisition acquisition{light};
  BurstLedger ledger;
  FakeGate gate;
  ProbeController controller{acquisition, light, ledger, config, &gate};
  HostTime now = host_time(1'000'000'000);
  Temperatures temperatures{.tip_cc = 3650, .led_cc = 3800, .soc_cc = 4500, .optics_cc = 3200};
  std::uint64_t next_id = 1;
  std::vector<Notice> notices;

  proto::CommandReply send(proto::Opcode opcode, std::uint32_t client = 1, std::int64_t arg = 0) {
    proto::Command c;
    c.cmd_id = next_id++;
    c.client_id = client;
    c.opcode = opcode;
    c.arg_i[0] = arg;
    return send(c);
  }
  proto::CommandReply send(const proto::Command& c) {
    auto reply = controller.handle(c, now);
    collect();
    return reply;
  }
  void tick(std::int64_t ms = 10) {
    now += Nanoseconds{ms * 1'000'000};
    controller.tick(now, temperatures);
    collect();
  }
  void collect() {
    for (Notice& n : controller.take_notices()) notices.push_back(std::move(n));
  }
  [[nodiscard]] proto::ProbeState state() const { return controller.state(); }
  void boot() {
    controller.boot(now);
    acquisition.end(AcquisitionPhase::kDone);
    tick();
  }
  void ready() {
    boot();
    send(proto::Opcode::kSessionOpen);
    send(proto::Opcode::kWarmup);
    acquisition.end(AcquisitionPhase::kDone);
    tick();
  }
  void scanning() {
    ready();
    send(proto::Opcode::kScanStart, 1, 7);
  }
  [[nodiscard]] bool told(std::uint16_t code) const {
    for (const Notice& n : notices) {
      if (n.code == code) return true;
    }
    return false;
  }
};

}  // namespace enamel::fw::test
