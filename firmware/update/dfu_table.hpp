// State machine of USB DFU 1.1 (appendix A) as a pure function: what a request or event does in a state. Used by the
// FunctionFS adapter, the emulated USB device, the simulated transport and the fuzzer alike.
#pragma once

#include <cstdint>

#include "protocol/image/dfu.hpp"

namespace enamel::fw {

using image::DfuRequest;
using image::DfuState;
using image::DfuStatus;

/// The 8 bytes of a control transfer's setup stage.
struct SetupPacket {
  std::uint8_t request_type = 0;
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
  std::uint16_t length = 0;
};

struct DfuConfig {
  bool can_download = true;
  bool can_upload = true;
  bool manifestation_tolerant = true;
  /// States appIDLE and appDETACH exist and a reset leads to them: the recovery image. The running firmware rests in
  /// dfuIDLE (docs/firmware-image.md §5).
  bool runtime = false;
};

/// What the request asks of whoever holds the data.
enum class DfuAction : std::uint8_t {
  kNone,
  kStall,
  kTakeBlock,     ///< the data stage is the next part of the image
  kSendBlock,     ///< fill the data stage; a short one ends the upload
  kFinish,        ///< the image is said to be complete: verify and make it bootable
  kAbort,         ///< forget the transfer
  kReplyStatus,   ///< six bytes of GETSTATUS
  kReplyState,    ///< one byte
  kDetach,        ///< a reset is expected within the timeout of the request
  kStartTimeout,  ///< reply status, then poll_timeout() follows
};

/// What the holder of the data knows when a request comes.
struct DfuConditions {
  bool busy = false;        ///< the last block or the manifestation is not finished
  bool complete = false;    ///< every byte of the image has come
  bool short_block = true;  ///< the upload's next block ends it
};

struct DfuPosition {
  DfuState state = DfuState::kIdle;
  DfuStatus status = DfuStatus::kOk;
  friend bool operator==(const DfuPosition&, const DfuPosition&) = default;
};

struct DfuStep {
  DfuPosition next;
  DfuAction action = DfuAction::kNone;
};

/// A class request. Requests that the standard does not know stall and change nothing else than an unexpected one
/// would.
[[nodiscard]] DfuStep on_request(DfuPosition at, const DfuConfig& config, const SetupPacket& setup,
                                 const DfuConditions& conditions) noexcept;

/// The bus was reset. `valid_firmware`: something bootable is installed.
[[nodiscard]] DfuPosition on_bus_reset(DfuPosition at, const DfuConfig& config, bool valid_firmware) noexcept;
/// The time that GETSTATUS told has passed.
[[nodiscard]] DfuPosition on_poll_timeout(DfuPosition at, const DfuConfig& config) noexcept;
/// No reset came within the time of DETACH.
[[nodiscard]] DfuPosition on_detach_timeout(DfuPosition at) noexcept;
/// A block or the manifestation failed.
[[nodiscard]] constexpr DfuPosition on_failure(DfuStatus why) noexcept { return {DfuState::kError, why}; }

}  // namespace enamel::fw
