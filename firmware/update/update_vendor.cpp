// Vendor requests of UpdateDevice (docs/firmware-image.md §5).
#include <algorithm>

#include "firmware/boot/transitions.hpp"
#include "firmware/update/update_device.hpp"

namespace enamel::fw {
namespace {

using image::Checked;
using image::Refusal;
using image::refuse;
using image::VendorRequest;

}  // namespace

ControlReply UpdateDevice::vendor(const SetupPacket& setup, std::span<const std::byte> data) noexcept {
  const auto request = static_cast<VendorRequest>(setup.request);
  const bool in = setup.request_type == image::request_type::kVendorIn;
  if (in) return vendor_in(request, setup);
  // Nothing of this in the middle of a transfer.
  if (at_.state != DfuState::kIdle && at_.state != DfuState::kAppIdle) return {true, {}};
  const Checked<void> done = act(request, setup.value, data);
  last_error_ = done ? 0 : static_cast<std::uint32_t>(done.error());
  return {!done, {}};
}

ControlReply UpdateDevice::vendor_in(VendorRequest request, const SetupPacket& setup) noexcept {
  if (request == VendorRequest::kStatus) {
    upload_ = encode(status());
    return {false, upload_};
  }
  if (request != VendorRequest::kCalibration) return {true, {}};
  const std::size_t offset = std::size_t{setup.value} * calibration_.size();
  const std::optional<std::size_t> n = services_->read_calibration(offset, calibration_);
  if (!n) last_error_ = static_cast<std::uint32_t>(Refusal::kNoCalibration);
  return {!n, std::span(calibration_).first(n.value_or(0))};
}

Checked<void> UpdateDevice::act(VendorRequest request, std::uint16_t value, std::span<const std::byte> data) noexcept {
  switch (request) {
    case VendorRequest::kReboot:
      if (services_->scanning()) return refuse(Refusal::kBusyScanning);
      services_->reboot(value == 1);
      return {};
    case VendorRequest::kConfirm:
      if (!may_confirm()) return refuse(Refusal::kNotConfirmed);
      return confirm_running(value == 1) ? Checked<void>{} : refuse(Refusal::kFlashWrite);
    case VendorRequest::kRollback: {
      if (identity_.recovery()) return refuse(Refusal::kNotConfirmed);
      const std::optional<ControlBlock> block = control_.load();
      const Checked<ControlBlock> back = roll_back(block.value_or(ControlBlock{}), identity_.running_slot);
      return back ? store(*back) : refuse(back.error());
    }
    case VendorRequest::kFactoryReset:
      return factory_reset(data);
    case VendorRequest::kSelfTest:
      return services_->self_test() ? Checked<void>{} : refuse(Refusal::kSelfTest);
    case VendorRequest::kAllowOlder:
      allow_older_ = true;
      return {};
    case VendorRequest::kStatus:
    case VendorRequest::kCalibration:
      break;
  }
  return refuse(Refusal::kMagic);
}

Checked<void> UpdateDevice::factory_reset(std::span<const std::byte> serial) noexcept {
  const std::span<const std::byte> own = std::as_bytes(std::span(serial_));
  if (!std::equal(serial.begin(), serial.end(), own.begin(), own.end())) return refuse(Refusal::kSerial);
  if (regions_.config.erase(0) != FlashStatus::kOk) return refuse(Refusal::kFlashWrite);
  return {};
}

Checked<void> UpdateDevice::store(const ControlBlock& block) noexcept {
  return control_.store(block) ? Checked<void>{} : refuse(Refusal::kFlashWrite);
}

bool UpdateDevice::may_confirm() const noexcept {
  if (identity_.recovery()) return false;
  const std::optional<ControlBlock> block = control_.load();
  return !block || block->slot[identity_.running_slot].state != SlotState::kBad;
}

bool UpdateDevice::confirm_running(bool commit_counter) noexcept {
  if (!may_confirm()) return false;
  // Both copies lost: what runs is known to boot, and that is written down anew.
  const std::optional<ControlBlock> block = control_.load();
  const ControlBlock confirmed = confirm(block.value_or(ControlBlock{}), identity_.running_slot);
  if (confirmed != block && !control_.store_twice(confirmed)) return false;
  return !commit_counter || control_.store(raise_counter(confirmed, true));
}

bool UpdateDevice::raise_counter_now() noexcept {
  const std::optional<ControlBlock> block = control_.load();
  if (!block) return false;
  const ControlBlock raised = raise_counter(*block, false);
  return raised == *block || control_.store(raised);
}

image::StatusBlock UpdateDevice::status() const noexcept {
  const ControlBlock block = control_.load().value_or(ControlBlock{});
  image::StatusBlock s;
  s.active = block.active;
  for (std::size_t i = 0; i < kSlots; ++i) {
    s.slot_state[i] = static_cast<std::uint8_t>(block.slot[i].state);
    s.tries[i] = block.slot[i].tries;
    s.version[i] = block.slot[i].version;
  }
  s.min_security_counter = block.min_security_counter;
  s.chunks_done = receiver_->chunks_done();
  s.chunks_total = receiver_->chunks_total();
  s.manifest_sha = block.slot[block.active].manifest_sha;
  s.serial = serial_;
  s.hw_rev = identity_.hardware.hw_rev;
  s.battery_mv = services_->battery_mv();
  s.last_error = last_error_;
  return s;
}

}  // namespace enamel::fw
