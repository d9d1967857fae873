// Makes a recording with every kind of message and, straight from the values, the JSON that a reader must arrive at.
// usage: interop_write zstd|plain capture.mcap expected.json
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "protocol/base/sha256.hpp"
#include "protocol/capture/capture.hpp"
#include "tests/unit/protocol/random_messages.hpp"

namespace {

using namespace enamel;
using nlohmann::json;

std::string big(std::uint64_t v) { return std::to_string(v); }
std::string big(std::int64_t v) { return std::to_string(v); }

json of(const proto::FrameMeta& m) {
  return {{"sensor_seq", m.sensor_seq},
          {"pattern_index", m.pattern_index},
          {"quality_flags", m.quality_flags},
          {"exposure_lines", m.exposure_lines},
          {"exposure_us", m.exposure_us},
          {"analogue_gain_q8", m.analogue_gain_q8},
          {"t_strobe_ns", big(m.t_strobe_ns)},
          {"t_sensor_ns", big(m.t_sensor_ns)},
          {"t_trig_rise_ns", big(m.t_trig_rise_ns)},
          {"t_trig_fall_ns", big(m.t_trig_fall_ns)},
          {"mean_q4", m.mean_q4},
          {"saturated_permille", m.saturated_permille},
          {"offset", m.offset},
          {"length", m.length}};
}

json of(const proto::Burst& b) {
  json metas = json::array();
  for (const auto& m : b.meta) metas.push_back(of(m));
  return {{"probe_id", b.probe_id},
          {"session_id", b.session_id},
          {"burst_seq", big(b.burst_seq)},
          {"burst_index", big(b.burst_index)},
          {"t_first_exposure_ns", big(b.t_first_exposure_ns)},
          {"t_publish_ns", big(b.t_publish_ns)},
          {"width", b.width},
          {"height", b.height},
          {"bit_depth", b.bit_depth},
          {"frames", b.frames},
          {"codec", static_cast<int>(b.codec)},
          {"pattern_set", b.pattern_set},
          {"frame_period_ns", b.frame_period_ns},
          {"illum_us", b.illum_us},
          {"led_current_code", b.led_current_code},
          {"temp_centi_c", b.temp_centi_c},
          {"calib_crc32", b.calib_crc32},
          {"payload_crc32", b.payload_crc32},
          {"accel_mps2", b.accel_mps2},
          {"gyro_rps", b.gyro_rps},
          {"meta", metas},
          {"payload", to_hex(b.payload)}};
}

json of(const proto::ShedNote& s) {
  return {{"burst_index", big(s.burst_index)},
          {"burst_seq", big(s.burst_seq)},
          {"t_host_ns", big(s.t_host_ns)},
          {"reason", static_cast<int>(s.reason)}};
}

json of(const proto::Status& s) {
  return {{"probe_id", s.probe_id},
          {"seq", s.seq},
          {"t_ns", big(s.t_ns)},
          {"state", static_cast<int>(s.state)},
          {"fault_mask", s.fault_mask},
          {"bursts_emitted", s.bursts_emitted},
          {"dropped", s.dropped},
          {"write_ms_p99", s.write_ms_p99},
          {"burst_rate_chz", s.burst_rate_chz},
          {"temp_tip_cc", s.temp_tip_cc},
          {"temp_led_cc", s.temp_led_cc},
          {"temp_soc_cc", s.temp_soc_cc},
          {"led_ma", s.led_ma},
          {"heater_permille", s.heater_permille},
          {"batt_mv", s.batt_mv},
          {"batt_pct", s.batt_pct},
          {"buttons", s.buttons},
          {"fw_version", s.fw_version},
          {"slot_active", s.slot_active},
          {"slot_state", to_hex(s.slot_state)},
          {"session_id", s.session_id},
          {"bursts_begun", s.bursts_begun}};
}

json of(const proto::Event& e) {
  return {{"probe_id", e.probe_id},
          {"seq", e.seq},
          {"t_ns", big(e.t_ns)},
          {"code", e.code},
          {"severity", static_cast<int>(e.severity)},
          {"text", e.text}};
}

// JSON has no NaN; the reader is given what its own numbers print.
json of(const proto::AxesReading& a) {
  const auto angle = [](double deg) { return std::isnan(deg) ? json("NaN") : json(deg); };
  return {{"probe_id", a.probe_id},
          {"session_id", a.session_id},
          {"burst_index", big(a.burst_index)},
          {"stop", a.stop},
          {"rot_cmd_deg", angle(a.rot_cmd_deg)},
          {"swing_cmd_deg", angle(a.swing_cmd_deg)},
          {"rot_read_deg", angle(a.rot_read_deg)},
          {"swing_read_deg", angle(a.swing_read_deg)}};
}

json of(const proto::DeviceInfo& d) {
  return {{"probe_id", d.probe_id},
          {"serial", d.serial},
          {"model", d.model},
          {"hw_rev", d.hw_rev},
          {"fw_version", d.fw_version},
          {"fw_manifest_sha256", to_hex(d.fw_manifest_sha256)},
          {"protocol_version", d.protocol_version},
          {"calib_crc32", d.calib_crc32},
          {"recovery", d.recovery},
          {"calibration_blob", to_hex(d.calibration_blob)}};
}

class Both {
 public:
  Both(capture::CaptureWriter& out, json& expected) : out_(out), expected_(expected) {}

  template <class T>
  void put(const char* topic, const T& value, Result<void> (capture::CaptureWriter::*write)(const T&, std::int64_t)) {
    const std::int64_t t = 1'700'000'000'000'000'000 + 1'000'003 * count_++;
    ok_ = ok_ && (out_.*write)(value, t).has_value();
    expected_["messages"][topic].push_back({{"log_ns", big(t)}, {"value", of(value)}});
  }
  [[nodiscard]] std::int64_t count() const { return count_; }
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  capture::CaptureWriter& out_;
  json& expected_;
  std::int64_t count_ = 0;
  bool ok_ = true;
};

template <class T>
T random_value(test::Random& random) {
  T value;
  test::randomize(random, value);
  return value;
}

json attachment(const std::string& name, const std::string& type, const proto::Bytes& data) {
  return {{"name", name}, {"media_type", type}, {"data", to_hex(data)}};
}

int run(bool compress, const std::string& path, const std::string& expected_path) {
  const std::string rig = "{\"format\": \"rig/1\"}\n";
  const capture::CaptureHeader header{rig, "interop 1", {{"seed", "4"}, {"unit", "\xC2\xB5m"}}};
  auto out = capture::CaptureWriter::create(path, header, {.compress = compress});
  if (!out) return 1;
  json expected;
  Both both(*out, expected);
  test::Random random(compress ? 21 : 22);
  using Writer = capture::CaptureWriter;
  both.put("enamel/v1/device_info", random_value<proto::DeviceInfo>(random), &Writer::write_device_info);
  for (std::uint64_t i = 0; i < 12; ++i) {
    both.put("enamel/v1/burst", i % 3 == 0 ? random_value<proto::Burst>(random) : test::camera_burst(i, 16, 12),
             &Writer::write_burst);
    both.put("enamel/v1/status", random_value<proto::Status>(random), &Writer::write_status);
    both.put("enamel/v1/shed", random_value<proto::ShedNote>(random), &Writer::write_shed);
    both.put("enamel/v1/event", random_value<proto::Event>(random), &Writer::write_event);
    if (i > 2) both.put("enamel/v1/axes", random_value<proto::AxesReading>(random), &Writer::write_axes);
  }
  const proto::Bytes truth = random.octets(500);
  if (!both.ok() || !out->attach("truth/poses.csv", "text/csv", truth) || !out->finish()) return 1;
  expected["attachments"] = {attachment("rig.json", "application/json", proto::Bytes(rig.begin(), rig.end())),
                             attachment("truth/poses.csv", "text/csv", truth)};
  expected["metadata"] = {
      {{"name", "enamel"}, {"values", {{"program", "interop 1"}, {"seed", "4"}, {"unit", "\xC2\xB5m"}}}}};
  expected["message_count"] = big(both.count());
  return std::ofstream(expected_path) << expected.dump(1) ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 1;
  return run(std::string(argv[1]) == "zstd", argv[2], argv[3]);
}
