#include "protocol/types/device.hpp"

namespace enamel::proto {

std::string_view name_of(ProbeState state) noexcept {
  static constexpr std::array<std::string_view, 11> kNames{
      "BOOT", "SELFTEST", "IDLE", "WARMUP", "READY", "SCANNING", "PAUSED", "FAULT", "SAFE", "UPDATING", "RECOVERY"};
  const auto i = static_cast<std::size_t>(state);
  return i < kNames.size() ? kNames[i] : "?";
}

std::string_view name_of(DropReason reason) noexcept {
  static constexpr std::array<std::string_view, kDropReasons> kNames{
      "frame_status", "seq_gap", "period",  "no_strobe",  "dup_strobe", "multi",      "partial",  "dark_leak",
      "dup_content",  "order",   "timeout", "queue_full", "encode",     "write_fail", "settling", "other"};
  const auto i = static_cast<std::size_t>(reason);
  return i < kNames.size() ? kNames[i] : "?";
}

std::string_view name_of(Opcode opcode) noexcept {
  switch (opcode) {
    case Opcode::kPing:
      return "PING";
    case Opcode::kSessionOpen:
      return "SESSION_OPEN";
    case Opcode::kSessionClose:
      return "SESSION_CLOSE";
    case Opcode::kWarmup:
      return "WARMUP";
    case Opcode::kScanStart:
      return "SCAN_START";
    case Opcode::kScanPause:
      return "SCAN_PAUSE";
    case Opcode::kScanStop:
      return "SCAN_STOP";
    case Opcode::kSingleBurst:
      return "SINGLE_BURST";
    case Opcode::kSetProfile:
      return "SET_PROFILE";
    case Opcode::kSetExposure:
      return "SET_EXPOSURE";
    case Opcode::kSetLed:
      return "SET_LED";
    case Opcode::kSetCodec:
      return "SET_CODEC";
    case Opcode::kSetHeater:
      return "SET_HEATER";
    case Opcode::kSelftest:
      return "SELFTEST";
    case Opcode::kCalibRead:
      return "CALIB_READ";
    case Opcode::kCalibWrite:
      return "CALIB_WRITE";
    case Opcode::kPatternVerify:
      return "PATTERN_VERIFY";
    case Opcode::kReboot:
      return "REBOOT";
    case Opcode::kFwConfirm:
      return "FW_CONFIRM";
    case Opcode::kFwRollback:
      return "FW_ROLLBACK";
    case Opcode::kLogLevel:
      return "LOG_LEVEL";
    case Opcode::kDiagDump:
      return "DIAG_DUMP";
    case Opcode::kFactoryReset:
      return "FACTORY_RESET";
    case Opcode::kSafeOff:
      return "SAFE_OFF";
  }
  return "?";
}

namespace {

struct StatusName {
  ReplyStatus status;
  std::string_view name;
};

constexpr std::array kStatusNames{
    StatusName{ReplyStatus::kOk, "OK"},
    StatusName{ReplyStatus::kBadArg, "BAD_ARG"},
    StatusName{ReplyStatus::kBadState, "BAD_STATE"},
    StatusName{ReplyStatus::kExpired, "EXPIRED"},
    StatusName{ReplyStatus::kNotOwner, "NOT_OWNER"},
    StatusName{ReplyStatus::kUnknownOp, "UNKNOWN_OP"},
    StatusName{ReplyStatus::kVersion, "VERSION"},
    StatusName{ReplyStatus::kBusy, "BUSY"},
    StatusName{ReplyStatus::kNoCamera, "NO_CAMERA"},
    StatusName{ReplyStatus::kCamConfig, "CAM_CONFIG"},
    StatusName{ReplyStatus::kCamTimeout, "CAM_TIMEOUT"},
    StatusName{ReplyStatus::kCamRestarted, "CAM_RESTARTED"},
    StatusName{ReplyStatus::kTsUnstable, "TS_UNSTABLE"},
    StatusName{ReplyStatus::kCamDisconnected, "CAM_DISCONNECTED"},
    StatusName{ReplyStatus::kProjI2c, "PROJ_I2C"},
    StatusName{ReplyStatus::kProjNotReady, "PROJ_NOT_READY"},
    StatusName{ReplyStatus::kProjTiming, "PROJ_TIMING"},
    StatusName{ReplyStatus::kProjSeqAbort, "PROJ_SEQ_ABORT"},
    StatusName{ReplyStatus::kProjLedFault, "PROJ_LED_FAULT"},
    StatusName{ReplyStatus::kProjWatchdog, "PROJ_WATCHDOG"},
    StatusName{ReplyStatus::kPatternCrc, "PATTERN_CRC"},
    StatusName{ReplyStatus::kProjId, "PROJ_ID"},
    StatusName{ReplyStatus::kEyeDose, "EYE_DOSE"},
    StatusName{ReplyStatus::kLedStuck, "LED_STUCK"},
    StatusName{ReplyStatus::kTipOvertemp, "TIP_OVERTEMP"},
    StatusName{ReplyStatus::kHeaterOpen, "HEATER_OPEN"},
    StatusName{ReplyStatus::kThermistor, "THERMISTOR"},
    StatusName{ReplyStatus::kSocOvertemp, "SOC_OVERTEMP"},
    StatusName{ReplyStatus::kInterlock, "INTERLOCK"},
    StatusName{ReplyStatus::kLinkTooSlow, "LINK_TOO_SLOW"},
    StatusName{ReplyStatus::kLeaseLost, "LEASE_LOST"},
    StatusName{ReplyStatus::kTimesync, "TIMESYNC"},
    StatusName{ReplyStatus::kBattLow, "BATT_LOW"},
    StatusName{ReplyStatus::kBattCritical, "BATT_CRITICAL"},
    StatusName{ReplyStatus::kVbusLost, "VBUS_LOST"},
    StatusName{ReplyStatus::kAssert, "ASSERT"},
    StatusName{ReplyStatus::kWatchdog, "WATCHDOG"},
    StatusName{ReplyStatus::kOomAtInit, "OOM_AT_INIT"},
};

}  // namespace

std::string_view name_of(ReplyStatus status) noexcept {
  for (const StatusName& s : kStatusNames) {
    if (s.status == status) return s.name;
  }
  return "?";
}

std::string clip_text(std::string_view text, std::size_t max_bytes) {
  if (text.size() > max_bytes) {
    std::size_t n = max_bytes;
    // A byte 10xxxxxx continues the character before it: cut in front of that character.
    while (n > 0 && (static_cast<unsigned char>(text[n]) & 0xC0U) == 0x80U) --n;
    text = text.substr(0, n);
  }
  return std::string(text);
}

}  // namespace enamel::proto
