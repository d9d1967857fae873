#include "firmware/app/probe.hpp"

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <span>

#include "firmware/app/lock_gate.hpp"
#include "firmware/app/open_device.hpp"
#include "firmware/control/dds_transport.hpp"
#include "firmware/control/vigil.hpp"
#include "firmware/publish/dds_burst_sink.hpp"
#include "protocol/base/crc32.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/base/log.hpp"

namespace enamel::fw {
namespace {

constexpr const char* kVersion = "0.1.0";
constexpr Nanoseconds kAcknowledgeTimeout{10'000'000'000};  // for a host to close a session that ended by itself
constexpr Nanoseconds kFlush{200'000'000};

std::uint32_t crc_of(const std::string& text) { return crc32(std::as_bytes(std::span(text))); }

proto::DeviceInfo device_info(const ProbeOptions& options, const Device& device) {
  const std::string& rig_text = device.rig_text();
  proto::DeviceInfo info;
  info.serial = options.serial;
  info.probe_id = crc_of(options.serial);
  info.model = device.model();
  info.fw_version = kVersion;
  info.calibration_blob.assign(rig_text.begin(), rig_text.end());
  info.calib_crc32 = crc_of(rig_text);
  return info;
}

ControllerConfig controller_config(Device& device) {
  const CameraMode mode = device.hardware().camera.mode();
  ControllerConfig config;
  config.max_silence = device.max_silence();
  config.has_heater = device.heater() != nullptr;
  config.drain_timeout =
      std::clamp(mode.frame_period * 8, Nanoseconds{150'000'000}, Nanoseconds{200'000'000}) + device.lateness();
  return config;
}

/// What the probe is put together from: its ends of the link and the gate.
struct ProbeEnds {
  DdsBurstSink sink;
  std::unique_ptr<DdsTransport> transport;
  std::unique_ptr<TimeSyncServer> time_sync;
  std::unique_ptr<LockGate> gate;  ///< null: never updated
};

/// Members in order of dependence; the acquisition stops before what it feeds.
struct Probe {
  Device& device;
  ProbeEnds ends;
  BurstLedger ledger;
  LightSwitch light;
  Publisher publisher;
  Acquisition acquisition;
  ProbeController controller;
  ControlServer server;

  Probe(Device& dev, ProbeEnds its_ends, Clock& clock, const proto::DeviceInfo& info)
      : device(dev),
        ends(std::move(its_ends)),
        light(dev.hardware().light),
        publisher(ends.sink, ledger, clock, publisher_config(info)),
        acquisition(
            dev.hardware(), light, ledger, [this](CapturedBurst b) { publisher.push(std::move(b)); },
            AcquisitionConfig{.max_delay_spread = dev.max_stamp_spread()}),
        controller(acquisition, light, ledger, controller_config(dev), ends.gate.get()),
        server({controller, *ends.transport, ledger, dev.hardware().thermal, dev.hardware().light,
                [this] { return link_rates(); }, dev.heater()},
               clock, ServerConfig{info.probe_id, info.fw_version}) {}

  static PublisherConfig publisher_config(const proto::DeviceInfo& info) {
    PublisherConfig config;
    config.burst.probe_id = info.probe_id;
    config.burst.calib_crc32 = info.calib_crc32;
    return config;
  }
  [[nodiscard]] LinkRates link_rates() const {
    const PublisherRates r = publisher.rates();
    return {r.burst_rate_chz, r.write_ms_p99};
  }
};

/// True when the program has done what it was started for.
class EndOfWork {
 public:
  EndOfWork(const ProbeOptions& options, HostTime now) : exit_after_session_(options.exit_after_session) {
    if (options.seconds) {
      end_ = now + Nanoseconds{static_cast<std::int64_t>(std::min(*options.seconds, 1e6) * 1e9)};
    }
  }
  [[nodiscard]] bool reached(const Probe& probe, HostTime now) {
    if (now >= end_) return true;
    if (!exit_after_session_) return false;
    if (probe.controller.source_ended()) {
      acknowledge_until_ = std::min(acknowledge_until_, now + kAcknowledgeTimeout);
      return probe.controller.session_closed() || now >= acknowledge_until_;
    }
    return probe.controller.session_closed() && probe.ledger.counts().begun > 0 &&
           probe.ledger.counts().under_way() == 0;
  }

 private:
  bool exit_after_session_;
  HostTime end_ = HostTime::max();
  HostTime acknowledge_until_ = HostTime::max();
};

/// Time that a slow source or machine cost is never hidden from the host: told at once, then after 2, 4, 8 … seconds.
class StretchReport {
 public:
  void check(Probe& probe, HostTime now) {
    const StretchCount count = probe.device.stretched();
    if (count.times == told_ || now < next_) return;
    told_ = count.times;
    pause_ *= 2;
    next_ = now + pause_;
    probe.server.publish({proto::kEventTimeStretched, proto::Severity::kInfo,
                          fmt::format("light is simulated slower than real time: stretched {} times by {} ms in all",
                                      count.times, count.total.count() / 1'000'000)});
  }

 private:
  std::uint64_t told_ = 0;
  Nanoseconds pause_{1'000'000'000};
  HostTime next_{};
};

void print_summary(const ProbeOptions& options, const proto::DeviceInfo& info, const Probe& probe) {
  const BurstCounts counts = probe.ledger.counts();
  nlohmann::ordered_json dropped = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < counts.dropped.size(); ++i) {
    if (counts.dropped[i] > 0) dropped[std::string(name_of(static_cast<proto::DropReason>(i)))] = counts.dropped[i];
  }
  const StretchCount stretch = probe.device.stretched();
  const nlohmann::ordered_json summary{
      {"serial", options.serial},
      {"probe_id", info.probe_id},
      {"session", counts.session.id.value},
      {"begun", counts.begun},
      {"emitted", counts.emitted},
      {"dropped", dropped},
      {"under_way", counts.under_way()},
      {"stretched", {{"times", stretch.times}, {"ms", stretch.total.count() / 1'000'000}}},
      {"state", std::string(name_of(probe.controller.state()))},
  };
  std::cout << json_text(summary) << std::endl;
}

Result<std::unique_ptr<LockGate>> open_gate(const std::string& path) {
  if (path.empty()) return nullptr;
  ENAMEL_TRY_ASSIGN(auto lock, ScanLock::open(path));
  return std::make_unique<LockGate>(std::move(lock));
}

Result<std::unique_ptr<Probe>> assemble(Device& device, Clock& clock, const dds::Participant& participant,
                                        const proto::DeviceInfo& info, std::unique_ptr<LockGate> gate) {
  ENAMEL_TRY_ASSIGN(auto sink, DdsBurstSink::create(participant));
  ENAMEL_TRY_ASSIGN(auto sync, TimeSyncServer::create(participant, info.probe_id, clock));
  ENAMEL_TRY_ASSIGN(auto link, DdsTransport::create(participant, info));
  ProbeEnds ends{std::move(sink), std::move(link), std::move(sync), std::move(gate)};
  return std::make_unique<Probe>(device, std::move(ends), clock, info);
}

}  // namespace

Result<int> run_probe(const ProbeOptions& options, const std::atomic<bool>& stop) {
  SteadyClock clock;
  ENAMEL_TRY_ASSIGN(auto gate, open_gate(options.scan_lock));
  ENAMEL_TRY_ASSIGN(const auto device, open_device(options, clock));
  const proto::DeviceInfo info = device_info(options, *device);
  ENAMEL_TRY_ASSIGN(const auto participant, dds::Participant::create(options.link));
  ENAMEL_TRY_ASSIGN(const auto probe, assemble(*device, clock, participant, info, std::move(gate)));
  const CameraMode mode = device->hardware().camera.mode();
  log::info("probe", "serial {}, id {:08x}, {}x{} at {:.1f} Hz, speed {}", info.serial, info.probe_id, mode.width,
            mode.height, 1e9 / static_cast<double>(mode.frame_period.count()), options.speed);

  EndOfWork end(options, clock.now());
  StretchReport stretch;
  Vigil vigil(device->watchdog(), device->max_silence());
  probe->controller.boot(clock.now());
  while (!stop.load(std::memory_order_acquire) && !end.reached(*probe, clock.now())) {
    probe->server.step();
    vigil.step(probe->controller.silence(), clock.now());
    stretch.check(*probe, clock.now());
  }
  probe->controller.shut_down();
  probe->server.publish_status();
  probe->ends.transport->flush(kFlush);
  if (options.json) print_summary(options, info, *probe);
  return 0;
}

}  // namespace enamel::fw
