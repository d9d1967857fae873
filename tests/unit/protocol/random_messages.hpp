// Messages with every member random, the same on every machine.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <random>

#include "protocol/base/crc32.hpp"
#include "protocol/types/axes.hpp"
#include "protocol/types/burst.hpp"
#include "protocol/types/device.hpp"

namespace enamel::test {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  template <class V>
  V number() {
    if constexpr (std::is_same_v<V, float>) {
      return static_cast<float>(static_cast<std::int32_t>(engine_())) * 0.0625F;
    } else if constexpr (std::is_same_v<V, double>) {
      return static_cast<double>(static_cast<std::int64_t>(engine_())) * 0.125;
    } else {
      return static_cast<V>(engine_());
    }
  }
  template <class V, std::size_t N>
  void fill(std::array<V, N>& a) {
    for (V& v : a) v = number<V>();
  }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }
  std::string text(std::size_t max) {
    std::string s(below(max + 1), ' ');
    for (char& c : s) c = static_cast<char>(1 + below(126));
    return s;
  }
  std::vector<std::uint8_t> octets(std::size_t n) {
    std::vector<std::uint8_t> bytes(n);
    for (std::uint8_t& b : bytes) b = number<std::uint8_t>();
    return bytes;
  }
  template <class... V>
  void set(V&... v) {
    ((v = number<V>()), ...);
  }

 private:
  std::mt19937_64 engine_;
};

inline proto::FrameMeta random_meta(Random& r) {
  proto::FrameMeta m;
  r.set(m.sensor_seq, m.pattern_index, m.quality_flags, m.exposure_lines, m.exposure_us, m.analogue_gain_q8,
        m.t_strobe_ns, m.t_sensor_ns, m.t_trig_rise_ns, m.t_trig_fall_ns, m.mean_q4, m.saturated_permille, m.offset,
        m.length);
  return m;
}

inline void randomize(Random& r, proto::Burst& b) {
  r.set(b.probe_id, b.session_id, b.burst_seq, b.burst_index, b.t_first_exposure_ns, b.t_publish_ns, b.width, b.height,
        b.bit_depth, b.frames, b.pattern_set, b.frame_period_ns, b.illum_us, b.led_current_code, b.temp_centi_c,
        b.calib_crc32, b.payload_crc32);
  b.codec = static_cast<proto::Codec>(r.below(5));
  r.fill(b.accel_mps2);
  r.fill(b.gyro_rps);
  b.meta.resize(r.below(9));
  for (auto& m : b.meta) m = random_meta(r);
  b.payload = r.octets(r.below(300));
}
inline void randomize(Random& r, proto::DeviceInfo& d) {
  r.set(d.probe_id, d.hw_rev, d.protocol_version, d.calib_crc32, d.recovery);
  d.serial = r.text(32);
  d.model = r.text(32);
  d.fw_version = r.text(32);
  r.fill(d.fw_manifest_sha256);
  d.calibration_blob = r.octets(r.below(2000));
}
inline void randomize(Random& r, proto::Status& s) {
  r.set(s.probe_id, s.seq, s.t_ns, s.fault_mask, s.bursts_emitted, s.write_ms_p99, s.burst_rate_chz, s.temp_tip_cc,
        s.temp_led_cc, s.temp_soc_cc, s.led_ma, s.heater_permille, s.batt_mv, s.batt_pct, s.buttons, s.slot_active,
        s.session_id, s.bursts_begun);
  s.state = static_cast<proto::ProbeState>(r.below(11));
  r.fill(s.dropped);
  s.fw_version = r.text(32);
  r.fill(s.slot_state);
}
inline void randomize(Random& r, proto::Command& c) {
  r.set(c.probe_id, c.cmd_id, c.client_id, c.deadline_ns);
  c.opcode = static_cast<proto::Opcode>(r.below(0x10000));
  r.fill(c.arg_i);
  r.fill(c.arg_f);
  c.arg_s = r.text(256);
}
inline void randomize(Random& r, proto::CommandReply& c) {
  r.set(c.probe_id, c.cmd_id, c.client_id, c.t_ns);
  c.status = static_cast<proto::ReplyStatus>(r.number<std::int32_t>());
  c.detail = r.text(256);
}
inline void randomize(Random& r, proto::Event& e) {
  r.set(e.probe_id, e.seq, e.t_ns, e.code);
  e.severity = static_cast<proto::Severity>(r.below(4));
  e.text = r.text(200);
}
inline void randomize(Random& r, proto::TimeSyncReq& t) { r.set(t.probe_id, t.seq, t.client_id, t.t1_host_ns); }
inline void randomize(Random& r, proto::TimeSyncRep& t) {
  r.set(t.probe_id, t.seq, t.client_id, t.t1_host_ns, t.t2_probe_ns, t.t3_probe_ns);
}
/// Any angle from end to end, one in four absent; where an axis has neither command nor reading is left to chance.
inline void randomize(Random& r, proto::AxesReading& a) {
  r.set(a.probe_id, a.session_id, a.burst_index, a.stop);
  for (double* deg : {&a.rot_cmd_deg, &a.swing_cmd_deg, &a.rot_read_deg, &a.swing_read_deg}) {
    const double share = static_cast<double>(r.below(2'000'001)) * 1e-6 - 1;
    *deg = r.below(4) == 0 ? std::numeric_limits<double>::quiet_NaN() : share * proto::kMaxAxisAngle_deg;
  }
}
inline void randomize(Random& r, proto::ShedNote& s) {
  r.set(s.burst_index, s.burst_seq, s.t_host_ns);
  s.reason = static_cast<proto::ShedReason>(r.below(3));
}

/// A burst that passes is_consistent(): random pixels of the given size, times in order, right CRC.
inline proto::Burst camera_burst(std::uint64_t index, int width, int height, int bit_depth = 8) {
  Random r(index + 1);
  proto::Burst b;
  randomize(r, b);
  b.probe_id = 0x1234;  // the key: samples of one probe keep their order
  b.burst_seq = index;
  b.burst_index = index;
  b.width = static_cast<std::uint16_t>(width);
  b.height = static_cast<std::uint16_t>(height);
  b.bit_depth = static_cast<std::uint8_t>(bit_depth);
  b.codec = bit_depth == 8 ? proto::Codec::kRaw8 : proto::Codec::kRaw16;
  b.frames = proto::kFramesPerBurst;
  const std::size_t frame =
      static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * (bit_depth == 8 ? 1U : 2U);
  b.payload = r.octets(frame * proto::kFramesPerBurst);
  b.payload_crc32 = crc32(std::as_bytes(std::span(b.payload)));
  b.meta.resize(proto::kFramesPerBurst);
  for (std::size_t k = 0; k < b.meta.size(); ++k) {
    b.meta[k] = random_meta(r);
    b.meta[k].pattern_index = static_cast<std::uint8_t>(k);
    b.meta[k].exposure_us = 3700;
    b.meta[k].t_strobe_ns = 1'000'000'000 + index * 33'333'333 + k * 4'004'000;
    b.meta[k].offset = static_cast<std::uint32_t>(k * frame);
    b.meta[k].length = static_cast<std::uint32_t>(frame);
  }
  b.t_first_exposure_ns = b.meta[0].t_strobe_ns;
  return b;
}

}  // namespace enamel::test
