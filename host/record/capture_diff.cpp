#include <string>

#include "host/record/burst_stream.hpp"
#include "host/record/capture_tools.hpp"
#include "protocol/types/axes_table.hpp"

namespace enamel::host {
namespace {

// Compares named members until the first that differs.
class FieldCompare {
 public:
  template <class V>
  void field(const std::string& name, const V& left, const V& right) {
    if (found_ || left == right) return;
    found_ = CaptureDifference{0, 0, name, text(left), text(right)};
  }
  void note(const std::string& name, const std::string& left, const std::string& right) {
    if (!found_) found_ = CaptureDifference{0, 0, name, left, right};
  }
  [[nodiscard]] bool found() const noexcept { return found_.has_value(); }
  [[nodiscard]] std::optional<CaptureDifference>& result() noexcept { return found_; }

 private:
  template <class V>
  static std::string text(const V& value) {
    if constexpr (std::is_enum_v<V>) {
      return std::to_string(static_cast<std::int64_t>(value));
    } else if constexpr (std::is_arithmetic_v<V>) {
      return std::to_string(value);
    } else if constexpr (std::is_same_v<V, std::string>) {
      return value;
    } else {
      std::string out;
      for (const auto& v : value) {
        if (out.size() > 120) return out + " …";
        out += (out.empty() ? "" : " ") + std::to_string(v);
      }
      return out;
    }
  }
  std::optional<CaptureDifference> found_;
};

void compare_pixels(FieldCompare& c, const proto::Burst& a, const proto::Burst& b) {
  c.field("payload.size", a.payload.size(), b.payload.size());
  if (c.found() || a.payload == b.payload) return;
  std::size_t at = 0;
  while (a.payload[at] == b.payload[at]) ++at;
  const std::size_t bytes = a.bit_depth > 8 ? 2 : 1;
  const std::size_t pixels = std::max<std::size_t>(std::size_t{a.width} * a.height, 1);
  const std::size_t width = std::max<std::size_t>(a.width, 1);
  const std::size_t pixel = at / bytes;
  const auto value = [&](const proto::Burst& x) {
    const std::size_t first = pixel * bytes;
    const unsigned high = bytes == 2 && first + 1 < x.payload.size() ? x.payload[first + 1] : 0U;
    return std::to_string(x.payload[first] + 256U * high);
  };
  const std::string where = "frame " + std::to_string(pixel / pixels) + ", row " +
                            std::to_string(pixel % pixels / width) + ", column " + std::to_string(pixel % width) + ": ";
  c.note("payload", where + value(a), where + value(b));
}

void compare_meta(FieldCompare& c, const std::string& at, const proto::FrameMeta& a, const proto::FrameMeta& b) {
  c.field(at + "sensor_seq", a.sensor_seq, b.sensor_seq);
  c.field(at + "pattern_index", a.pattern_index, b.pattern_index);
  c.field(at + "quality_flags", a.quality_flags, b.quality_flags);
  c.field(at + "exposure_lines", a.exposure_lines, b.exposure_lines);
  c.field(at + "exposure_us", a.exposure_us, b.exposure_us);
  c.field(at + "analogue_gain_q8", a.analogue_gain_q8, b.analogue_gain_q8);
  c.field(at + "t_strobe_ns", a.t_strobe_ns, b.t_strobe_ns);
  c.field(at + "t_sensor_ns", a.t_sensor_ns, b.t_sensor_ns);
  c.field(at + "t_trig_rise_ns", a.t_trig_rise_ns, b.t_trig_rise_ns);
  c.field(at + "t_trig_fall_ns", a.t_trig_fall_ns, b.t_trig_fall_ns);
  c.field(at + "mean_q4", a.mean_q4, b.mean_q4);
  c.field(at + "saturated_permille", a.saturated_permille, b.saturated_permille);
  c.field(at + "offset", a.offset, b.offset);
  c.field(at + "length", a.length, b.length);
}

void compare(FieldCompare& c, const proto::Burst& a, const proto::Burst& b) {
  c.field("burst_index", a.burst_index, b.burst_index);
  c.field("burst_seq", a.burst_seq, b.burst_seq);
  c.field("probe_id", a.probe_id, b.probe_id);
  c.field("session_id", a.session_id, b.session_id);
  c.field("t_first_exposure_ns", a.t_first_exposure_ns, b.t_first_exposure_ns);
  c.field("t_publish_ns", a.t_publish_ns, b.t_publish_ns);
  c.field("width", a.width, b.width);
  c.field("height", a.height, b.height);
  c.field("bit_depth", a.bit_depth, b.bit_depth);
  c.field("frames", a.frames, b.frames);
  c.field("codec", a.codec, b.codec);
  c.field("pattern_set", a.pattern_set, b.pattern_set);
  c.field("frame_period_ns", a.frame_period_ns, b.frame_period_ns);
  c.field("illum_us", a.illum_us, b.illum_us);
  c.field("led_current_code", a.led_current_code, b.led_current_code);
  c.field("temp_centi_c", a.temp_centi_c, b.temp_centi_c);
  c.field("calib_crc32", a.calib_crc32, b.calib_crc32);
  c.field("accel_mps2", a.accel_mps2, b.accel_mps2);
  c.field("gyro_rps", a.gyro_rps, b.gyro_rps);
  c.field("meta.size", a.meta.size(), b.meta.size());
  for (std::size_t k = 0; k < std::min(a.meta.size(), b.meta.size()); ++k) {
    compare_meta(c, "meta[" + std::to_string(k) + "].", a.meta[k], b.meta[k]);
  }
  compare_pixels(c, a, b);
  c.field("payload_crc32", a.payload_crc32, b.payload_crc32);
}

void compare(FieldCompare& c, const proto::ShedNote& a, const proto::ShedNote& b) {
  c.field("shed.burst_index", a.burst_index, b.burst_index);
  c.field("shed.burst_seq", a.burst_seq, b.burst_seq);
  c.field("shed.t_host_ns", a.t_host_ns, b.t_host_ns);
  c.field("shed.reason", a.reason, b.reason);
}

void compare(FieldCompare& c, const proto::Status& a, const proto::Status& b) {
  c.field("status.seq", a.seq, b.seq);
  c.field("status.t_ns", a.t_ns, b.t_ns);
  c.field("status.state", a.state, b.state);
  c.field("status.bursts_emitted", a.bursts_emitted, b.bursts_emitted);
  c.field("status.dropped", a.dropped, b.dropped);
  if (!(a == b)) c.note("status", "seq " + std::to_string(a.seq), "another member of the same seq");
}

void compare(FieldCompare& c, const proto::Event& a, const proto::Event& b) {
  c.field("event.seq", a.seq, b.seq);
  c.field("event.t_ns", a.t_ns, b.t_ns);
  c.field("event.code", a.code, b.code);
  c.field("event.text", a.text, b.text);
  if (!(a == b)) c.note("event", "seq " + std::to_string(a.seq), "another member of the same seq");
}

void compare(FieldCompare& c, const proto::DeviceInfo& a, const proto::DeviceInfo& b) {
  c.field("device_info.serial", a.serial, b.serial);
  c.field("device_info.fw_version", a.fw_version, b.fw_version);
  c.field("device_info.calib_crc32", a.calib_crc32, b.calib_crc32);
  if (!(a == b)) c.note("device_info", a.serial, "another member of the same device");
}

void compare(FieldCompare& c, const proto::AxesReading& a, const proto::AxesReading& b) {
  c.field("axes.burst_index", a.burst_index, b.burst_index);
  c.field("axes.stop", a.stop, b.stop);
  c.field("axes.probe_id", a.probe_id, b.probe_id);
  c.field("axes.session_id", a.session_id, b.session_id);
  if (a.has_angles_of(b)) return;
  const auto row = [](proto::AxesReading r) {
    const std::string table = proto::axes_table_text({r});
    return table.substr(table.find('\n') + 1, table.size() - table.find('\n') - 2);
  };
  c.note("axes.deg", row(a), row(b));
}

constexpr const char* kKindNames[] = {"burst", "shed", "status", "event", "device_info", "axes"};

void compare_records(FieldCompare& c, const capture::Record& a, const capture::Record& b, bool with_log_times) {
  if (a.value.index() != b.value.index()) {
    c.note("kind", kKindNames[a.value.index()], kKindNames[b.value.index()]);
    return;
  }
  std::visit([&](const auto& left) { compare(c, left, std::get<std::decay_t<decltype(left)>>(b.value)); }, a.value);
  if (with_log_times) c.field("log_ns", a.log_ns, b.log_ns);
}

std::uint64_t burst_index_of(const capture::Record& record) {
  if (const auto* burst = std::get_if<proto::Burst>(&record.value)) return burst->burst_index;
  if (const auto* note = std::get_if<proto::ShedNote>(&record.value)) return note->burst_index;
  if (const auto* reading = std::get_if<proto::AxesReading>(&record.value)) return reading->burst_index;
  return 0;
}

}  // namespace

Result<std::optional<CaptureDifference>> capture_diff(const std::string& left, const std::string& right,
                                                      bool with_log_times) {
  ENAMEL_TRY_ASSIGN(const auto a, open_bursts(left));
  ENAMEL_TRY_ASSIGN(const auto b, open_bursts(right));
  FieldCompare c;
  if (a->rig_text() != b->rig_text()) {
    c.note("rig", std::to_string(a->rig_text().size()) + " bytes", std::to_string(b->rig_text().size()) + " bytes");
    return c.result();
  }
  for (std::uint64_t n = 0;; ++n) {
    ENAMEL_TRY_ASSIGN(const auto x, a->next());
    ENAMEL_TRY_ASSIGN(const auto y, b->next());
    if (!x && !y) return std::optional<CaptureDifference>{};
    if (x && y) {
      compare_records(c, *x, *y, with_log_times);
    } else {
      c.note("records", x ? "another record" : "end", y ? "another record" : "end");
    }
    if (!c.found()) continue;
    c.result()->ordinal = n;
    c.result()->burst_index = burst_index_of(x ? *x : *y);
    return c.result();
  }
}

}  // namespace enamel::host
