#include "firmware/gadget/control_loop.hpp"

#include <algorithm>
#include <optional>

namespace enamel::fw {

Result<void> ControlLoop::step(std::chrono::milliseconds deadline) {
  // While the slot is read back, requests are looked for between two pieces of it, not waited for.
  const std::chrono::milliseconds wait = device_->work_pending() ? std::chrono::milliseconds(0) : deadline;
  ENAMEL_TRY_ASSIGN(const std::optional<PortEvent> event, port_->next(wait));
  if (event) handle(*event);
  if (device_->work_pending()) device_->work();
  return {};
}

void ControlLoop::handle(const PortEvent& event) {
  switch (event.kind) {
    case PortEventKind::kSetup:
      ++counts_.transfers;
      return answer(event.setup);
    case PortEventKind::kDisable:
    case PortEventKind::kUnbind:
      // A reset of the bus, another configuration or a pulled cable; FunctionFS does not tell them apart, and each ends
      // the transfer in hand (DFU 1.1 §7).
      ++counts_.resets;
      return device_->bus_reset();
    case PortEventKind::kBind:
    case PortEventKind::kEnable:  // also SET_INTERFACE, which keeps the state
    case PortEventKind::kSuspend:
    case PortEventKind::kResume:
      return;
  }
}

void ControlLoop::answer(const SetupPacket& setup) {
  const bool in = (setup.request_type & 0x80U) != 0;
  if (!in && setup.length > 0) return take_data(setup);
  SetupPacket asked = setup;
  asked.length = std::min(asked.length, image::kDfuTransferSize);
  const ControlReply reply = device_->control(asked, {});
  if (reply.stall) {
    ++counts_.stalled;
    return port_->stall(setup);
  }
  const bool done = in ? port_->send(reply.data) : port_->acknowledge();
  if (!done) ++counts_.given_up;
}

void ControlLoop::take_data(const SetupPacket& setup) {
  if (setup.length > data_.size()) {
    ++counts_.stalled;
    return port_->stall(setup);
  }
  const std::span<std::byte> data = std::span(data_).first(setup.length);
  if (port_->receive(data) != data.size()) {
    ++counts_.given_up;
    return;
  }
  if (device_->control(setup, data).stall) ++counts_.stalled;
}

}  // namespace enamel::fw
