// Carries control transfers between endpoint 0 and the update: what comes on the port goes to UpdateDevice, its answer
// back.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>

#include "firmware/gadget/control_port.hpp"
#include "firmware/update/update_device.hpp"

namespace enamel::fw {

/// What the port has seen since the start.
struct PortCounts {
  std::uint64_t transfers = 0;
  std::uint64_t stalled = 0;
  std::uint64_t given_up = 0;  ///< a data stage that the host broke off
  std::uint64_t resets = 0;
};

/// Not thread-safe. A data stage that comes short changes nothing in the device: it stays in its state and the host
/// repeats. An OUT transfer with data is acknowledged by the kernel when its data has come, before it can be judged; a
/// refusal of it is seen by GETSTATUS (DFU) or in the status block (vendor requests).
class ControlLoop {
 public:
  ControlLoop(ControlPort& port, UpdateDevice& device) noexcept : port_(&port), device_(&device) {}

  /// Waits for one event, answers it, and does a piece of what it left to do (UpdateDevice::work). kGadget when the
  /// function is gone.
  [[nodiscard]] Result<void> step(std::chrono::milliseconds deadline);
  [[nodiscard]] const PortCounts& counts() const noexcept { return counts_; }

 private:
  void handle(const PortEvent& event);
  void answer(const SetupPacket& setup);
  void take_data(const SetupPacket& setup);

  ControlPort* port_;
  UpdateDevice* device_;
  std::array<std::byte, image::kDfuTransferSize> data_{};
  PortCounts counts_;
};

}  // namespace enamel::fw
