// One probe from "connected" to "new firmware confirmed": preflight, download, manifestation, restart, confirmation
// (docs/flashing.md). Success is said only by the new firmware.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <string_view>

#include "host/update/dfu_client.hpp"
#include "protocol/image/manifest.hpp"

namespace enamel::update {

enum class Step : std::uint8_t { kPreflight, kTransfer, kGone, kVerify, kRestart, kConfirm, kDone };

struct FlashProgress {
  Step step = Step::kPreflight;
  double share = 0;  ///< of everything, 0 to 1; weights: manifest 2, transfer 78, verify 10, restart and confirm 10
  double seconds_left = 0;  ///< estimate; 0 while unknown
};

/// Something that happened, for a log. Names: docs/flashing.md, "The log".
struct FlashEvent {
  std::string_view event;
  std::uint32_t block = 0;  ///< of the download, from 0; 0 where no block is meant
  std::string status;
};

/// The event that people are told of, too.
inline constexpr std::string_view kSlowPort = "slow port";

/// Called from the thread that flashes.
struct FlashObserver {
  std::function<void(const FlashProgress&)> progress;
  std::function<void(const FlashEvent&)> event;
};

struct FlashRequest {
  std::span<const std::byte> image;  ///< the file without its suffix, checked
  image::Manifest manifest;
  bool allow_same = false;
  bool allow_older = false;
  bool dry_run = false;
  std::chrono::milliseconds return_deadline{30'000};   ///< for the probe to come back, on the cable or after restart;
                                                       ///< in its first third at its own port, then at any
  std::chrono::milliseconds confirm_deadline{90'000};  ///< for its self-test
};

struct FlashResult {
  std::string serial;
  image::ImageVersion before, after;
  bool written = false;  ///< false: it ran this version already, or a dry run
};

/// Blocks until done, refused or cancelled. The probe is found again by serial, or by port while it has none.
[[nodiscard]] Updated<FlashResult> flash(UsbBus& bus, Clock& clock, const PortInfo& probe, const FlashRequest& request,
                                         const FlashObserver& observer, const std::atomic<bool>& stop);

}  // namespace enamel::update
