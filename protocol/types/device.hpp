// What probe and host tell each other besides bursts: identity, status, commands, events, clock exchange.
// Plain values, mirrors of the structs of the same name in protocol/idl/scanner.idl; no DDS here.
// Suffixes: _ns, _cc 0.01 degC, _chz 0.01 Hz, _permille. String members have the byte limits given beside them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/types/burst.hpp"

namespace enamel::proto {

inline constexpr std::uint32_t kProtocolVersion = 1;

enum class ProbeState : std::uint32_t {
  kBoot,
  kSelftest,
  kIdle,
  kWarmup,
  kReady,
  kScanning,
  kPaused,
  kFault,
  kSafe,
  kUpdating,
  kRecovery
};
[[nodiscard]] std::string_view name_of(ProbeState state) noexcept;  ///< "SCANNING"; "?" when out of range

/// Index into Status::dropped: why the probe gave up or withheld a burst.
enum class DropReason : std::uint8_t {
  kFrameStatus,
  kSeqGap,
  kPeriod,
  kNoStrobe,
  kDupStrobe,
  kMulti,
  kPartial,
  kDarkLeak,
  kDupContent,
  kOrder,
  kTimeout,
  kQueueFull,
  kEncode,
  kWriteFail,
  kSettling,
  kOther
};
inline constexpr std::size_t kDropReasons = 16;
[[nodiscard]] std::string_view name_of(DropReason reason) noexcept;  ///< "queue_full"; "?" when out of range

enum class Opcode : std::uint16_t {
  kPing = 0x01,
  kSessionOpen = 0x02,
  kSessionClose = 0x03,
  kWarmup = 0x10,
  kScanStart = 0x11,
  kScanPause = 0x12,
  kScanStop = 0x13,
  kSingleBurst = 0x14,
  kSetProfile = 0x20,
  kSetExposure = 0x21,
  kSetLed = 0x22,
  kSetCodec = 0x23,
  kSetHeater = 0x24,
  kSelftest = 0x30,
  kCalibRead = 0x31,
  kCalibWrite = 0x32,
  kPatternVerify = 0x33,
  kReboot = 0x40,
  kFwConfirm = 0x41,
  kFwRollback = 0x42,
  kLogLevel = 0x50,
  kDiagDump = 0x51,
  kFactoryReset = 0x60,
  kSafeOff = 0x7F,  ///< accepted in every state, from any client
};
[[nodiscard]] std::string_view name_of(Opcode opcode) noexcept;  ///< "SCAN_START"; "?" when unknown

/// CommandReply::status: 0, or -(class * 100 + n).
enum class ReplyStatus : std::int32_t {
  kOk = 0,
  kBadArg = -101,
  kBadState = -102,
  kExpired = -103,
  kNotOwner = -104,
  kUnknownOp = -105,
  kVersion = -106,
  kBusy = -107,
  kNoCamera = -201,
  kCamConfig = -202,
  kCamTimeout = -203,
  kCamRestarted = -204,
  kTsUnstable = -205,
  kCamDisconnected = -206,
  kProjI2c = -301,
  kProjNotReady = -302,
  kProjTiming = -303,
  kProjSeqAbort = -304,
  kProjLedFault = -305,
  kProjWatchdog = -306,
  kPatternCrc = -307,
  kProjId = -308,
  kEyeDose = -501,
  kLedStuck = -502,
  kTipOvertemp = -503,
  kHeaterOpen = -504,
  kThermistor = -505,
  kSocOvertemp = -506,
  kInterlock = -507,
  kLinkTooSlow = -601,
  kLeaseLost = -602,
  kTimesync = -603,
  kBattLow = -801,
  kBattCritical = -802,
  kVbusLost = -803,
  kAssert = -901,
  kWatchdog = -902,
  kOomAtInit = -903,
};
[[nodiscard]] std::string_view name_of(ReplyStatus status) noexcept;  ///< "BAD_STATE"; "?" when unknown

struct DeviceInfo {
  std::uint32_t probe_id = 0;
  std::string serial{};  ///< <= 32 bytes
  std::string model{};   ///< <= 32 bytes
  std::uint16_t hw_rev = 0;
  std::string fw_version{};  ///< <= 32 bytes
  std::array<std::uint8_t, 32> fw_manifest_sha256{};
  std::uint32_t protocol_version = kProtocolVersion;
  std::uint32_t calib_crc32 = 0;  ///< CRC-32 of calibration_blob
  std::uint8_t recovery = 0;
  std::vector<std::uint8_t> calibration_blob{};  ///< rig.json byte for byte, <= 65536 bytes
  friend bool operator==(const DeviceInfo&, const DeviceInfo&) = default;
};

struct Status {
  std::uint32_t probe_id = 0;
  std::uint32_t seq = 0;
  std::uint64_t t_ns = 0;  ///< device clock
  ProbeState state = ProbeState::kBoot;
  std::uint32_t fault_mask = 0;
  std::uint32_t bursts_emitted = 0;
  std::array<std::uint32_t, kDropReasons> dropped{};
  std::uint16_t write_ms_p99 = 0;
  std::uint16_t burst_rate_chz = 0;
  std::int16_t temp_tip_cc = 0;
  std::int16_t temp_led_cc = 0;
  std::int16_t temp_soc_cc = 0;
  std::uint16_t led_ma = 0;
  std::uint16_t heater_permille = 0;
  std::uint16_t batt_mv = 0;
  std::uint8_t batt_pct = 0;
  std::uint8_t buttons = 0;
  std::string fw_version{};  ///< <= 32 bytes
  std::uint8_t slot_active = 0;
  std::array<std::uint8_t, 2> slot_state{};
  std::uint32_t session_id = 0;    ///< that the counters belong to; 0 before the first
  std::uint32_t bursts_begun = 0;  ///< = bursts_emitted + sum of dropped + those under way
  friend bool operator==(const Status&, const Status&) = default;
};

/// Idempotent by cmd_id: the probe answers a repeated cmd_id with the reply it gave before.
struct Command {
  std::uint32_t probe_id = 0;
  std::uint64_t cmd_id = 0;
  std::uint32_t client_id = 0;
  Opcode opcode = Opcode::kPing;
  std::array<std::int64_t, 4> arg_i{};
  std::array<double, 4> arg_f{};
  std::string arg_s{};            ///< <= 256 bytes
  std::uint64_t deadline_ns = 0;  ///< device clock; 0 = none. A command past it is answered kExpired, never executed
  friend bool operator==(const Command&, const Command&) = default;
};

struct CommandReply {
  std::uint32_t probe_id = 0;
  std::uint64_t cmd_id = 0;
  std::uint32_t client_id = 0;
  ReplyStatus status = ReplyStatus::kOk;
  std::string detail{};  ///< <= 256 bytes
  std::uint64_t t_ns = 0;
  friend bool operator==(const CommandReply&, const CommandReply&) = default;
};

/// Event codes beside states and faults.
inline constexpr std::uint16_t kEventSessionEnded = 1000;   ///< finite source played to its end; counters are final
inline constexpr std::uint16_t kEventTimeStretched = 1001;  ///< simulated light came later than real time asked for

enum class Severity : std::uint8_t { kInfo = 0, kWarning = 1, kError = 2, kSafety = 3 };

struct Event {
  std::uint32_t probe_id = 0;
  std::uint32_t seq = 0;
  std::uint64_t t_ns = 0;  ///< device clock
  std::uint16_t code = 0;  ///< ProbeState entered, |ReplyStatus| of a fault, or kEvent…
  Severity severity = Severity::kInfo;
  std::string text{};  ///< <= 200 bytes
  friend bool operator==(const Event&, const Event&) = default;
};

struct TimeSyncReq {
  std::uint32_t probe_id = 0;
  std::uint32_t seq = 0;
  std::uint32_t client_id = 0;
  std::int64_t t1_host_ns = 0;
  friend bool operator==(const TimeSyncReq&, const TimeSyncReq&) = default;
};

struct TimeSyncRep {
  std::uint32_t probe_id = 0;
  std::uint32_t seq = 0;
  std::uint32_t client_id = 0;
  std::int64_t t1_host_ns = 0;
  std::int64_t t2_probe_ns = 0;
  std::int64_t t3_probe_ns = 0;
  friend bool operator==(const TimeSyncRep&, const TimeSyncRep&) = default;
};

enum class ShedReason : std::uint8_t { kIngressFull = 0, kPaused = 1, kOther = 2 };

/// The host's note in a recording: a burst that arrived whole and was dropped on purpose. Never on the wire.
struct ShedNote {
  std::uint64_t burst_index = 0;
  std::uint64_t burst_seq = 0;
  std::int64_t t_host_ns = 0;
  ShedReason reason = ShedReason::kIngressFull;
  friend bool operator==(const ShedNote&, const ShedNote&) = default;
};

/// Shortens to at most `max_bytes` without cutting a UTF-8 sequence: for texts of unbounded origin in bounded members.
[[nodiscard]] std::string clip_text(std::string_view text, std::size_t max_bytes);

}  // namespace enamel::proto
