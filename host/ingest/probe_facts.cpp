#include "host/ingest/probe_facts.hpp"

#include <span>

#include "protocol/base/crc32.hpp"

namespace enamel::host {

Result<std::string> rig_text_of(const proto::DeviceInfo& info) {
  std::string text(info.calibration_blob.begin(), info.calibration_blob.end());
  if (text.empty()) return fail(ErrorCode::kRigMissing, "probe " + info.serial + " carries none");
  if (crc32(std::as_bytes(std::span(text))) != info.calib_crc32)
    return fail(ErrorCode::kRigInvalid, "damaged on its way from the probe");
  return text;
}

bool says_simulated(const proto::DeviceInfo& info) { return info.model.find("SIMULATED") != std::string::npos; }

DeviceTime end_of_exposure(const proto::Burst& burst) {
  const proto::FrameMeta& last = burst.meta.back();
  return device_time(static_cast<std::int64_t>(last.t_strobe_ns) + std::int64_t{last.exposure_us} * 1000);
}

std::uint32_t new_session_id(const Clock& clock) {
  return static_cast<std::uint32_t>(to_ns(clock.now()) / 1'000'000) | 1U;
}

}  // namespace enamel::host
