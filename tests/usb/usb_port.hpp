// An emulated USB port with a probe in it: real libusb programs see it through umockdev, which stands between them and
// the kernel. Simulation.
#pragma once

#include <umockdev.h>

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "tests/usb/probe_model.hpp"

namespace enamel::test {

/// What happens to the connection, counted in blocks of a download.
struct PortFaults {
  std::optional<std::uint32_t> pull_at_block;  ///< unplugged there, for good or until `replug_ms`
  std::optional<std::uint32_t> replug_ms;
  std::uint32_t stalls_at_block = 0;  ///< that block stalls `stall_count` times
  std::uint32_t stall_count = 0;
};

class UsbPort {
 public:
  /// Port number from 1; the probe is plugged in.
  UsbPort(UMockdevTestbed* testbed, int number, const ProbeOptions& probe, const PortFaults& faults);
  ~UsbPort();
  UsbPort(const UsbPort&) = delete;
  UsbPort& operator=(const UsbPort&) = delete;

  [[nodiscard]] ProbeModel& probe() { return probe_; }
  [[nodiscard]] bool plugged() const { return plugged_; }

 private:
  static void on_vanished(UMockdevIoctlBase* base, UMockdevIoctlClient* client, gpointer self);
  static gboolean on_ioctl(UMockdevIoctlBase* base, UMockdevIoctlClient* client, gpointer self);
  /// Calls `what` after a while, on the thread that called this.
  void later(std::uint32_t ms, GSourceFunc what);
  static gboolean on_reboot(gpointer self);
  static gboolean on_return(gpointer self);

  gboolean handle(UMockdevIoctlClient* client);
  gboolean submit(UMockdevIoctlClient* client);
  gboolean reap(UMockdevIoctlClient* client);
  /// Runs the transfer of a URB; its status, negative errno.
  int transfer(const fw::SetupPacket& setup, std::span<std::byte> buffer, std::size_t& length);
  int standard_request(const fw::SetupPacket& setup, std::span<std::byte> buffer, std::size_t& length) const;
  [[nodiscard]] bool faulty(const fw::SetupPacket& setup);
  void forget_transfers();
  void plug_in();
  void pull_out();

  UMockdevTestbed* testbed_;
  int number_;
  std::string syspath_, devnode_;
  ProbeModel probe_;
  PortFaults faults_;
  UMockdevIoctlBase* handler_ = nullptr;
  std::map<UMockdevIoctlClient*, std::deque<UMockdevIoctlData*>> done_;  ///< finished transfers of each open file
  std::uint32_t blocks_ = 0;
  bool plugged_ = false;
  bool attached_ = false;
};

}  // namespace enamel::test
