// Endpoint 0 through Linux' FunctionFS (linux/usb/functionfs.h): descriptors in, events out, data stages both ways.
#pragma once

#include <sys/types.h>

#include <memory>
#include <string>

#include "firmware/gadget/control_port.hpp"
#include "firmware/gadget/interrupt_timer.hpp"
#include "protocol/base/clock.hpp"

namespace enamel::fw {

/// Not thread-safe; for programs of one thread (InterruptTimer). Closing it takes the gadget off its bus.
class FunctionFs final : public ControlPort {
 public:
  /// Opens `mount`/ep0 and writes descriptors and strings: with the DFU functional descriptor, and where the kernel
  /// refuses that, without. Mounts nothing; the clock must outlive it. kFileNotFound; kGadget when the kernel takes
  /// neither.
  [[nodiscard]] static Result<std::unique_ptr<FunctionFs>> open(const std::string& mount, Clock& clock,
                                                                const DfuConfig& config = {});
  ~FunctionFs() override;
  FunctionFs(const FunctionFs&) = delete;
  FunctionFs& operator=(const FunctionFs&) = delete;

  /// The kernel took the DFU functional descriptor.
  [[nodiscard]] bool functional_descriptor() const noexcept { return functional_; }

  [[nodiscard]] Result<std::optional<PortEvent>> next(std::chrono::milliseconds deadline) override;
  [[nodiscard]] std::size_t receive(std::span<std::byte> data) override;
  [[nodiscard]] bool send(std::span<const std::byte> data) override;
  [[nodiscard]] bool acknowledge() override;
  void stall(const SetupPacket& setup) override;

 private:
  FunctionFs(int ep0, Clock& clock) noexcept : ep0_(ep0), clock_(clock) {}
  [[nodiscard]] Result<void> describe(const DfuConfig& config);
  [[nodiscard]] ssize_t answered(ssize_t n, std::size_t wanted) noexcept;
  void settle() noexcept;

  int ep0_;
  Clock& clock_;
  bool functional_ = true;
  SetupPacket setup_;       ///< the last one taken
  bool unsettled_ = false;  ///< its answer failed: the kernel may still wait for one
  InterruptTimer timer_;
};

}  // namespace enamel::fw
