// An emulated USB port with a probe in it: real libusb programs see it through umockdev, which stands between them and
// the kernel. Simulation.
#pragma once

#include <sys/types.h>
#include <umockdev.h>

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "tests/usb/probe_model.hpp"
#include "tests/usb/transfer_meter.hpp"
#include "tests/usb/usb_identity.hpp"

namespace enamel::test {

/// What happens to the connection, counted in blocks of a download, from 1.
struct PortFaults {
  std::optional<std::uint32_t> pull_at_block;  ///< unplugged there, for good or until `replug_ms`
  std::optional<std::uint32_t> replug_ms;
  std::optional<int> replug_port;     ///< comes back there instead of at its own port
  bool power_lost = false;            ///< the pulled probe has no battery: it boots when it comes back
  std::uint32_t stalls_at_block = 0;  ///< from that block on, `stall_count` blocks stall
  std::uint32_t stall_count = 0;
  std::uint32_t silent_at_block = 0;  ///< from that block on, `silent_count` blocks get no answer
  std::uint32_t silent_count = 0;
  std::optional<std::uint32_t> interrupt_at_block;  ///< the program under test gets SIGINT
  int speed_mbit = 480;
  std::optional<mode_t> mode;  ///< of the device node, for programs that run as somebody else
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
  /// The program whose transfers these are: metered, and interrupted where the faults say so.
  void watch(pid_t program) { meter_.watch(program); }
  [[nodiscard]] const TransferMeter& meter() const { return meter_; }

 private:
  static constexpr std::uint32_t kRebootMs = 300;
  using Urbs = std::deque<UMockdevIoctlData*>;
  enum class Fault : std::uint8_t { kNone, kStall, kSilence };

  static void on_connected(UMockdevIoctlBase* base, UMockdevIoctlClient* client, gpointer self);
  static void on_vanished(UMockdevIoctlBase* base, UMockdevIoctlClient* client, gpointer self);
  static gboolean on_ioctl(UMockdevIoctlBase* base, UMockdevIoctlClient* client, gpointer self);
  /// Calls `what` after a while, on the thread that called this.
  void later(std::uint32_t ms, GSourceFunc what);
  static gboolean on_reboot(gpointer self);
  static gboolean on_return(gpointer self);
  static gboolean on_work(gpointer self);
  static gboolean on_replug(gpointer self);

  gboolean handle(UMockdevIoctlClient* client);
  gboolean submit(UMockdevIoctlClient* client);
  gboolean reap(UMockdevIoctlClient* client);
  gboolean discard(UMockdevIoctlClient* client);
  /// Runs the transfer of a URB; its status, negative errno.
  int transfer(const fw::SetupPacket& setup, std::span<std::byte> buffer, std::size_t& length);
  int standard_request(const fw::SetupPacket& setup, std::span<std::byte> buffer, std::size_t& length) const;
  /// Counts blocks of a download and says what is wrong with this one; may pull the cable.
  [[nodiscard]] Fault next_fault(const fw::SetupPacket& setup);
  /// Transfers that get no answer end with `status`, negative errno, and can be reaped.
  static void end_silent(Urbs& silent, Urbs& done, int status);
  void forget(UMockdevIoctlClient* client);
  void plug_in();
  void pull_out();
  [[nodiscard]] UsbIdentity identity() const;

  UMockdevTestbed* testbed_;
  int number_;
  ProbeModel probe_;
  PortFaults faults_;
  TransferMeter meter_;
  UMockdevIoctlBase* handler_ = nullptr;
  std::map<UMockdevIoctlClient*, Urbs> done_;    ///< finished transfers of each open file
  std::map<UMockdevIoctlClient*, Urbs> silent_;  ///< those that never will be, until the program gives them up
  std::set<UMockdevIoctlClient*> open_;          ///< files opened since the probe was plugged in last
  std::set<std::string> attached_;               ///< device nodes that the handler answers for
  std::uint32_t blocks_ = 0;
  bool plugged_ = false;
  bool working_ = false;  ///< on_work comes again
};

}  // namespace enamel::test
