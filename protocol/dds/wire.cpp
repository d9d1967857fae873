#include "protocol/dds/wire.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

namespace enamel::dds {
namespace {

template <std::size_t N>
bool put_text(char (&out)[N], const std::string& text) {
  if (text.size() >= N || text.find('\0') != std::string::npos) return false;
  std::copy(text.begin(), text.end(), out);
  std::fill(out + text.size(), out + N, '\0');
  return true;
}

template <class V, std::size_t N>
void put_array(V (&out)[N], const std::array<V, N>& in) {
  std::copy(in.begin(), in.end(), out);
}

Result<void> checked(bool fits, const char* what) {
  if (fits) return {};
  return fail(ErrorCode::kMessageInvalid, std::string(what) + " is longer than its bound or holds a zero byte");
}

enamel_v1_FrameMeta wire_meta(const proto::FrameMeta& m) {
  return {m.sensor_seq,       m.pattern_index,      m.quality_flags, m.exposure_lines, m.exposure_us,
          m.analogue_gain_q8, m.t_strobe_ns,        m.t_sensor_ns,   m.t_trig_rise_ns, m.t_trig_fall_ns,
          m.mean_q4,          m.saturated_permille, m.offset,        m.length};
}

constexpr std::size_t kMaxMetas = 8;
constexpr std::size_t kMaxBlob = 65536;

// dds_write only reads the buffer; the C struct has no const.
dds_sequence_octet octets(const std::vector<std::uint8_t>& bytes) {
  const auto n = static_cast<std::uint32_t>(bytes.size());
  return {n, n, const_cast<std::uint8_t*>(bytes.data()), false};
}

}  // namespace

Result<void> Wire<proto::Burst>::fill(Type& wire, const proto::Burst& b) {
  thread_local std::array<enamel_v1_FrameMeta, kMaxMetas> metas;
  if (b.meta.size() > kMaxMetas) return checked(false, "meta");
  std::transform(b.meta.begin(), b.meta.end(), metas.begin(), wire_meta);
  wire.probe_id = b.probe_id;
  wire.session_id = b.session_id;
  wire.burst_seq = b.burst_seq;
  wire.burst_index = b.burst_index;
  wire.t_first_exposure_ns = b.t_first_exposure_ns;
  wire.t_publish_ns = b.t_publish_ns;
  wire.width = b.width;
  wire.height = b.height;
  wire.bit_depth = b.bit_depth;
  wire.frames = b.frames;
  wire.codec = static_cast<std::uint8_t>(b.codec);
  wire.pattern_set = b.pattern_set;
  wire.frame_period_ns = b.frame_period_ns;
  wire.illum_us = b.illum_us;
  wire.led_current_code = b.led_current_code;
  wire.temp_centi_c = b.temp_centi_c;
  wire.calib_crc32 = b.calib_crc32;
  wire.payload_crc32 = b.payload_crc32;
  put_array(wire.accel_mps2, b.accel_mps2);
  put_array(wire.gyro_rps, b.gyro_rps);
  const auto n = static_cast<std::uint32_t>(b.meta.size());
  wire.meta = {n, n, metas.data(), false};
  wire.payload = octets(b.payload);
  return {};
}

Result<void> Wire<proto::DeviceInfo>::fill(Type& wire, const proto::DeviceInfo& d) {
  wire.probe_id = d.probe_id;
  ENAMEL_TRY(checked(put_text(wire.serial, d.serial), "serial"));
  ENAMEL_TRY(checked(put_text(wire.model, d.model), "model"));
  wire.hw_rev = d.hw_rev;
  ENAMEL_TRY(checked(put_text(wire.fw_version, d.fw_version), "fw_version"));
  put_array(wire.fw_manifest_sha256, d.fw_manifest_sha256);
  wire.protocol_version = d.protocol_version;
  wire.calib_crc32 = d.calib_crc32;
  wire.recovery = d.recovery;
  ENAMEL_TRY(checked(d.calibration_blob.size() <= kMaxBlob, "calibration_blob"));
  wire.calibration_blob = {kMaxBlob, static_cast<std::uint32_t>(d.calibration_blob.size()),
                           const_cast<std::uint8_t*>(d.calibration_blob.data()), false};
  return {};
}

Result<void> Wire<proto::Status>::fill(Type& wire, const proto::Status& s) {
  wire.probe_id = s.probe_id;
  wire.seq = s.seq;
  wire.t_ns = s.t_ns;
  ENAMEL_TRY(checked(s.state <= proto::ProbeState::kRecovery, "state"));
  wire.state = static_cast<enamel_v1_ProbeState>(s.state);
  wire.fault_mask = s.fault_mask;
  wire.bursts_emitted = s.bursts_emitted;
  put_array(wire.dropped, s.dropped);
  wire.write_ms_p99 = s.write_ms_p99;
  wire.burst_rate_chz = s.burst_rate_chz;
  wire.temp_tip_cc = s.temp_tip_cc;
  wire.temp_led_cc = s.temp_led_cc;
  wire.temp_soc_cc = s.temp_soc_cc;
  wire.led_ma = s.led_ma;
  wire.heater_permille = s.heater_permille;
  wire.batt_mv = s.batt_mv;
  wire.batt_pct = s.batt_pct;
  wire.buttons = s.buttons;
  ENAMEL_TRY(checked(put_text(wire.fw_version, s.fw_version), "fw_version"));
  wire.slot_active = s.slot_active;
  put_array(wire.slot_state, s.slot_state);
  wire.session_id = s.session_id;
  wire.bursts_begun = s.bursts_begun;
  return {};
}

Result<void> Wire<proto::Command>::fill(Type& wire, const proto::Command& c) {
  wire.probe_id = c.probe_id;
  wire.cmd_id = c.cmd_id;
  wire.client_id = c.client_id;
  wire.opcode = static_cast<std::uint16_t>(c.opcode);
  put_array(wire.arg_i, c.arg_i);
  put_array(wire.arg_f, c.arg_f);
  wire.deadline_ns = c.deadline_ns;
  return checked(put_text(wire.arg_s, c.arg_s), "arg_s");
}

Result<void> Wire<proto::CommandReply>::fill(Type& wire, const proto::CommandReply& r) {
  wire.probe_id = r.probe_id;
  wire.cmd_id = r.cmd_id;
  wire.client_id = r.client_id;
  wire.status = static_cast<std::int32_t>(r.status);
  wire.t_ns = r.t_ns;
  return checked(put_text(wire.detail, r.detail), "detail");
}

Result<void> Wire<proto::Event>::fill(Type& wire, const proto::Event& e) {
  wire.probe_id = e.probe_id;
  wire.seq = e.seq;
  wire.t_ns = e.t_ns;
  wire.code = e.code;
  wire.severity = static_cast<std::uint8_t>(e.severity);
  return checked(put_text(wire.text, e.text), "text");
}

Result<void> Wire<proto::TimeSyncReq>::fill(Type& wire, const proto::TimeSyncReq& r) {
  wire = {r.probe_id, r.seq, r.client_id, r.t1_host_ns};
  return {};
}

Result<void> Wire<proto::TimeSyncRep>::fill(Type& wire, const proto::TimeSyncRep& r) {
  wire = {r.probe_id, r.seq, r.client_id, r.t1_host_ns, r.t2_probe_ns, r.t3_probe_ns};
  return {};
}

Result<void> Wire<proto::AxesReading>::fill(Type& wire, const proto::AxesReading& r) {
  for (const double deg : {r.rot_cmd_deg, r.swing_cmd_deg, r.rot_read_deg, r.swing_read_deg}) {
    if (std::abs(deg) > proto::kMaxAxisAngle_deg)
      return fail(ErrorCode::kMessageInvalid, "angle beyond the travel of any axis");
  }
  wire = {r.probe_id,    r.session_id,    r.burst_index,  r.stop,
          r.rot_cmd_deg, r.swing_cmd_deg, r.rot_read_deg, r.swing_read_deg};
  return {};
}

Result<void> Wire<proto::ShedNote>::fill(Type& wire, const proto::ShedNote& n) {
  wire = {n.burst_index, n.burst_seq, n.t_host_ns, static_cast<std::uint8_t>(n.reason)};
  return {};
}

}  // namespace enamel::dds
