// The members of every message in the order of scanner.idl, described once for encoder and decoder. Private to cdr.cpp.
#pragma once

#include <concepts>
#include <type_traits>

#include "protocol/types/axes.hpp"
#include "protocol/types/burst.hpp"
#include "protocol/types/device.hpp"

namespace enamel::proto::detail {

template <class M, class T>
concept Is = std::same_as<std::remove_const_t<M>, T>;

/// @final types are plain, all others delimited.
template <class T>
inline constexpr bool kFinal = std::same_as<T, Burst>;

inline constexpr std::size_t kMaxMetas = 8;
inline constexpr std::size_t kMaxCalibration = 65536;
inline constexpr std::size_t kUnbounded = ~std::size_t{0};

template <class Ar, Is<FrameMeta> M>
void visit(Ar& ar, M& m) {
  ar.values(m.sensor_seq, m.pattern_index, m.quality_flags, m.exposure_lines, m.exposure_us, m.analogue_gain_q8);
  ar.values(m.t_strobe_ns, m.t_sensor_ns, m.t_trig_rise_ns, m.t_trig_fall_ns);
  ar.values(m.mean_q4, m.saturated_permille, m.offset, m.length);
}

template <class Ar, Is<Burst> M>
void visit(Ar& ar, M& m) {
  ar.values(m.probe_id, m.session_id, m.burst_seq, m.burst_index, m.t_first_exposure_ns, m.t_publish_ns);
  ar.values(m.width, m.height, m.bit_depth, m.frames);
  ar.template enumerator<std::uint8_t>(m.codec, 255);
  ar.values(m.pattern_set, m.frame_period_ns, m.illum_us, m.led_current_code, m.temp_centi_c);
  ar.values(m.calib_crc32, m.payload_crc32, m.accel_mps2, m.gyro_rps);
  ar.structs(m.meta, kMaxMetas);
  ar.octets(m.payload, kUnbounded);
}

template <class Ar, Is<Command> M>
void visit(Ar& ar, M& m) {
  ar.values(m.probe_id, m.cmd_id, m.client_id);
  ar.template enumerator<std::uint16_t>(m.opcode, 0xFFFF);
  ar.values(m.arg_i, m.arg_f);
  ar.text(m.arg_s, 256);
  ar.values(m.deadline_ns);
}

template <class Ar, Is<CommandReply> M>
void visit(Ar& ar, M& m) {
  ar.values(m.probe_id, m.cmd_id, m.client_id);
  ar.template enumerator<std::int32_t>(m.status, 0x7FFFFFFF);
  ar.text(m.detail, 256);
  ar.values(m.t_ns);
}

template <class Ar, Is<Status> M>
void visit(Ar& ar, M& m) {
  ar.values(m.probe_id, m.seq, m.t_ns);
  ar.template enumerator<std::uint32_t>(m.state, static_cast<std::uint32_t>(ProbeState::kRecovery));
  ar.values(m.fault_mask, m.bursts_emitted, m.dropped, m.write_ms_p99, m.burst_rate_chz);
  ar.values(m.temp_tip_cc, m.temp_led_cc, m.temp_soc_cc, m.led_ma, m.heater_permille, m.batt_mv);
  ar.values(m.batt_pct, m.buttons);
  ar.text(m.fw_version, 32);
  ar.values(m.slot_active, m.slot_state, m.session_id, m.bursts_begun);
}

template <class Ar, Is<TimeSyncReq> M>
void visit(Ar& ar, M& m) {
  ar.values(m.probe_id, m.seq, m.client_id, m.t1_host_ns);
}

template <class Ar, Is<TimeSyncRep> M>
void visit(Ar& ar, M& m) {
  ar.values(m.probe_id, m.seq, m.client_id, m.t1_host_ns, m.t2_probe_ns, m.t3_probe_ns);
}

template <class Ar, Is<Event> M>
void visit(Ar& ar, M& m) {
  ar.values(m.probe_id, m.seq, m.t_ns, m.code);
  ar.template enumerator<std::uint8_t>(m.severity, 255);
  ar.text(m.text, 200);
}

template <class Ar, Is<DeviceInfo> M>
void visit(Ar& ar, M& m) {
  ar.values(m.probe_id);
  ar.text(m.serial, 32);
  ar.text(m.model, 32);
  ar.values(m.hw_rev);
  ar.text(m.fw_version, 32);
  ar.values(m.fw_manifest_sha256, m.protocol_version, m.calib_crc32, m.recovery);
  ar.octets(m.calibration_blob, kMaxCalibration);
}

template <class Ar, Is<AxesReading> M>
void visit(Ar& ar, M& m) {
  ar.values(m.probe_id, m.session_id, m.burst_index, m.stop);
  for (auto* deg : {&m.rot_cmd_deg, &m.swing_cmd_deg, &m.rot_read_deg, &m.swing_read_deg}) ar.angle(*deg);
}

template <class Ar, Is<ShedNote> M>
void visit(Ar& ar, M& m) {
  ar.values(m.burst_index, m.burst_seq, m.t_host_ns);
  ar.template enumerator<std::uint8_t>(m.reason, 255);
}

}  // namespace enamel::proto::detail
