// Names of USB DFU 1.1 (usb.org, Device Class Specification for Device Firmware Upgrade, Revision 1.1) that both sides
// use.
#pragma once

#include <cstddef>
#include <cstdint>

namespace enamel::image {

enum class DfuState : std::uint8_t {
  kAppIdle = 0,
  kAppDetach = 1,
  kIdle = 2,
  kDownloadSync = 3,
  kDownloadBusy = 4,
  kDownloadIdle = 5,
  kManifestSync = 6,
  kManifest = 7,
  kManifestWaitReset = 8,
  kUploadIdle = 9,
  kError = 10,
};
inline constexpr std::size_t kDfuStates = 11;

enum class DfuStatus : std::uint8_t {
  kOk = 0x00,
  kErrTarget = 0x01,
  kErrFile = 0x02,
  kErrWrite = 0x03,
  kErrErase = 0x04,
  kErrCheckErased = 0x05,
  kErrProg = 0x06,
  kErrVerify = 0x07,
  kErrAddress = 0x08,
  kErrNotDone = 0x09,
  kErrFirmware = 0x0A,
  kErrVendor = 0x0B,
  kErrUsbReset = 0x0C,
  kErrPowerOn = 0x0D,
  kErrUnknown = 0x0E,
  kErrStalledPacket = 0x0F,
};

enum class DfuRequest : std::uint8_t {
  kDetach = 0,
  kDownload = 1,
  kUpload = 2,
  kGetStatus = 3,
  kClearStatus = 4,
  kGetState = 5,
  kAbort = 6,
};

/// Vendor requests, docs/firmware-image.md §5.
enum class VendorRequest : std::uint8_t {
  kReboot = 0x01,
  kConfirm = 0x02,
  kRollback = 0x03,
  kFactoryReset = 0x04,
  kSelfTest = 0x05,
  kAllowOlder = 0x06,
  kStatus = 0x10,
  kCalibration = 0x11,
};

/// bmRequestType of the requests above: class or vendor, to the interface, towards the device or from it.
namespace request_type {
inline constexpr std::uint8_t kClassOut = 0x21;
inline constexpr std::uint8_t kClassIn = 0xA1;
inline constexpr std::uint8_t kVendorOut = 0x41;
inline constexpr std::uint8_t kVendorIn = 0xC1;
}  // namespace request_type

/// Longest control transfer that Linux's usbfs and gadget layer carry.
inline constexpr std::uint16_t kDfuTransferSize = 4096;

inline constexpr std::uint16_t kUsbVendor = 0x1209;
inline constexpr std::uint16_t kUsbProduct = 0x0001;          ///< running firmware
inline constexpr std::uint16_t kUsbProductRecovery = 0x0002;  ///< recovery image

}  // namespace enamel::image
