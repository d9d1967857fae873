// A SIMULATED USB camera on this machine's bus: USB/IP with the kernel's vhci_hcd over a socket pair, so that uvcvideo
// and libcamera drive it as they drive any other.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <span>

#include "tests/guest/camera/uvc_device.hpp"

namespace enamel::guest {

/// Header of a USB/IP message, drivers/usb/usbip/usbip_common.h: 48 bytes, big endian.
struct UsbipHeader {
  std::array<std::uint32_t, 12> word{};
  [[nodiscard]] std::uint32_t command() const;
  [[nodiscard]] std::uint32_t sequence() const;
  [[nodiscard]] std::uint32_t direction() const;
  [[nodiscard]] std::uint32_t endpoint() const;
  [[nodiscard]] std::uint32_t length() const;
  [[nodiscard]] std::uint32_t unlinked() const;
  [[nodiscard]] Setup setup() const;
};
static_assert(sizeof(UsbipHeader) == 48);

/// Fills the pixels of frame `number` at the moment when the sensor has exposed it.
using FrameContent = std::function<void(std::uint32_t number, std::span<std::uint8_t> pixels)>;

class UsbipCamera {
 public:
  UsbipCamera(UvcMode mode, FrameContent content);
  /// Plugs it in. False, with a message on stderr, where there is no vhci_hcd.
  [[nodiscard]] bool attach();
  /// Serves it until the kernel closes the connection; 0 then.
  int run();

 private:
  using Clock = std::chrono::steady_clock;
  bool take();
  bool unlink(const UsbipHeader& header);
  void send_part();
  bool reply(const UsbipHeader& to, int status, const Bytes& data, std::uint32_t taken);
  [[nodiscard]] std::chrono::nanoseconds period() const;
  [[nodiscard]] int ms_to_next() const;
  bool read_all(void* to, std::size_t size);
  bool write_all(const void* from, std::size_t size);

  int socket_ = -1;
  UvcDevice device_;
  FrameContent content_;
  Bytes payload_;
  std::size_t at_ = 0;  ///< bytes of the payload already sent
  std::uint32_t counter_ = 0;
  Clock::time_point next_ = Clock::now();
  std::deque<UsbipHeader> waiting_;
};

}  // namespace enamel::guest
