// Endpoint 0 of the probe's USB function as the update sees it. FunctionFS stands behind it, or a model in tests.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/update/dfu_table.hpp"
#include "protocol/base/result.hpp"

namespace enamel::fw {

enum class PortEventKind : std::uint8_t { kBind, kUnbind, kEnable, kDisable, kSetup, kSuspend, kResume };

struct PortEvent {
  PortEventKind kind = PortEventKind::kBind;
  SetupPacket setup;  ///< of kSetup only
};

/// Not thread-safe. After a kSetup exactly one of receive, send, acknowledge and stall answers it; a host that gave up
/// meanwhile makes them fail, which is no error of the port: the host repeats.
class ControlPort {
 public:
  virtual ~ControlPort() = default;
  /// Nothing: nothing came before the deadline, or a signal did. kGadget when the function is gone for good.
  [[nodiscard]] virtual Result<std::optional<PortEvent>> next(std::chrono::milliseconds deadline) = 0;
  /// Data stage of an OUT transfer and its acknowledgement; the number of bytes that came, fewer than asked for when
  /// the host gave up or the deadline of the port passed.
  [[nodiscard]] virtual std::size_t receive(std::span<std::byte> data) = 0;
  /// Data stage of an IN transfer.
  [[nodiscard]] virtual bool send(std::span<const std::byte> data) = 0;
  /// An OUT transfer without data.
  [[nodiscard]] virtual bool acknowledge() = 0;
  virtual void stall(const SetupPacket& setup) = 0;
};

}  // namespace enamel::fw
