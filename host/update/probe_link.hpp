// A probe on USB as the updater sees it: control transfers on endpoint 0. libusb stands behind it, or a model in tests.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

namespace enamel::update {

enum class LinkFault : std::uint8_t { kStall, kTimeout, kGone, kDenied, kBusy, kOther };
[[nodiscard]] std::string to_text(LinkFault fault);

template <class T>
using Linked = tl::expected<T, LinkFault>;

/// What can be known of a probe without opening it, plus its serial where that could be read.
struct PortInfo {
  std::string port;    ///< bus and ports, "1-2.4": stays when the probe comes back
  std::string serial;  ///< empty when it could not be opened
  std::uint16_t product = 0;
  std::uint16_t bcd_device = 0;
  int speed_mbit = 0;
  bool denied = false;
  std::string model{};  ///< as the probe calls itself; empty when it could not be opened
  [[nodiscard]] bool recovery() const noexcept;
};

/// The fixed part of a setup packet; interface and length follow from the call.
struct ControlRequest {
  std::uint8_t type = 0;
  std::uint8_t request = 0;
  std::uint16_t value = 0;
};

/// One open probe. Not thread-safe; different probes may be used from different threads.
class ProbeLink {
 public:
  virtual ~ProbeLink() = default;
  /// `data`: at most image::kDfuTransferSize bytes.
  [[nodiscard]] virtual Linked<void> out(const ControlRequest& request, std::span<const std::byte> data,
                                         std::chrono::milliseconds timeout) = 0;
  /// The bytes that came, at most `length`.
  [[nodiscard]] virtual Linked<std::vector<std::byte>> in(const ControlRequest& request, std::uint16_t length,
                                                          std::chrono::milliseconds timeout) = 0;
  /// out(), and queued behind it in(): one wait for both. The fault of the first that failed; the probe has then
  /// still seen the second.
  [[nodiscard]] virtual Linked<std::vector<std::byte>> out_then_in(const ControlRequest& first,
                                                                   std::span<const std::byte> data,
                                                                   const ControlRequest& second, std::uint16_t length,
                                                                   std::chrono::milliseconds timeout) = 0;
};

/// Thread-safe.
class UsbBus {
 public:
  virtual ~UsbBus() = default;
  /// Probes and probes in recovery, by port. Never changes a probe's mode.
  [[nodiscard]] virtual std::vector<PortInfo> probes() = 0;
  /// The probe at a port, without touching those at others, which may be at work.
  [[nodiscard]] virtual std::optional<PortInfo> probe_at(const std::string& port) = 0;
  [[nodiscard]] virtual Linked<std::unique_ptr<ProbeLink>> open(const std::string& port) = 0;
};

/// libusb; nothing when it cannot be initialised.
[[nodiscard]] std::unique_ptr<UsbBus> open_usb_bus();

}  // namespace enamel::update
