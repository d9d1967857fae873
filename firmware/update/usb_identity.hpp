// Who the probe says it is on USB: the same unit under two product ids, so that a host can tell run mode from recovery
// (docs/firmware-image.md §5).
#pragma once

#include <array>
#include <cstdint>

#include "firmware/update/dfu_table.hpp"
#include "firmware/update/image_receiver.hpp"

namespace enamel::fw {

struct UsbIdentity {
  std::uint16_t vendor = image::kUsbVendor;
  std::uint16_t product = image::kUsbProduct;
  std::uint16_t bcd_device = 0;  ///< major << 8 | minor of the running firmware, 0 in recovery
};

[[nodiscard]] constexpr UsbIdentity usb_identity(const UpdateIdentity& identity) noexcept {
  UsbIdentity usb;
  if (identity.recovery()) {
    usb.product = image::kUsbProductRecovery;
  } else {
    usb.bcd_device =
        static_cast<std::uint16_t>(identity.running_version->major << 8U | identity.running_version->minor);
  }
  return usb;
}

/// How long a host has for the reset after DETACH, ms.
inline constexpr std::uint16_t kDetachTimeoutMs = 1000;

/// DFU functional descriptor (DFU 1.1 §4.1.3).
[[nodiscard]] constexpr std::array<std::uint8_t, 9> dfu_functional_descriptor(const DfuConfig& config) noexcept {
  constexpr std::uint16_t kDfuVersion = 0x0110;
  const auto attributes = static_cast<std::uint8_t>((config.can_download ? 1U : 0U) | (config.can_upload ? 2U : 0U) |
                                                    (config.manifestation_tolerant ? 4U : 0U));
  return {9,
          0x21,
          attributes,
          kDetachTimeoutMs & 0xFFU,
          kDetachTimeoutMs >> 8U,
          image::kDfuTransferSize & 0xFFU,
          image::kDfuTransferSize >> 8U,
          kDfuVersion & 0xFFU,
          kDfuVersion >> 8U};
}

}  // namespace enamel::fw
