#include "firmware/update/update_device.hpp"

#include <algorithm>

#include "firmware/boot/transitions.hpp"

namespace enamel::fw {
namespace {

using image::Checked;
using image::Refusal;
namespace request_type = image::request_type;
using image::refuse;

/// Reading 16 MiB back and hashing it takes about half a second on the probe's processor. A host may ask earlier.
constexpr std::uint32_t kManifestMs = 500;

ControlReply stalled() noexcept { return {true, {}}; }

}  // namespace

UpdateDevice::UpdateDevice(const BootRegions& regions, const UpdateIdentity& identity, const image::Serial& serial,
                           UpdateServices& services, const DfuConfig& config)
    : regions_(regions),
      identity_(identity),
      serial_(serial),
      services_(&services),
      config_(config),
      control_(regions.control),
      receiver_(std::make_unique<ImageReceiver>(regions, identity)) {
  if (config.runtime) at_.state = DfuState::kAppIdle;
}

ControlReply UpdateDevice::control(const SetupPacket& setup, std::span<const std::byte> data) noexcept {
  const bool out = (setup.request_type & 0x80U) == 0;
  if (out && data.size() != setup.length) return stalled();
  const bool ours = setup.request_type == request_type::kVendorOut || setup.request_type == request_type::kVendorIn;
  ControlReply reply = ours ? vendor(setup, data) : dfu(setup, data);
  reply.data = reply.data.first(std::min<std::size_t>(reply.data.size(), setup.length));
  return reply;
}

ControlReply UpdateDevice::dfu(const SetupPacket& setup, std::span<const std::byte> data) noexcept {
  const DfuConditions now{.busy = finish_pending_,
                          .complete = receiver_->complete(),
                          .short_block = image::kStatusSize - uploaded_ < setup.length};
  const DfuState before = at_.state;
  const DfuStep step = on_request(at_, config_, setup, now);
  at_ = step.next;
  if (at_.state == DfuState::kError) give_up(at_.status);
  if (step.action == DfuAction::kDetach) detach_timeout_ms_ = setup.value;
  switch (step.action) {
    case DfuAction::kNone:
    case DfuAction::kDetach:
      return {};
    case DfuAction::kStall:
      if (at_.status == DfuStatus::kErrNotDone) last_error_ = static_cast<std::uint32_t>(Refusal::kTruncated);
      return stalled();
    case DfuAction::kTakeBlock:
      if (before == DfuState::kIdle) {
        receiver_->restart(allow_older_);
        last_error_ = 0;
        next_block_ = setup.value;
      }
      take_block(setup, data);
      return {};
    case DfuAction::kSendBlock:
      if (before == DfuState::kIdle) {
        uploaded_ = 0;
        upload_ = encode(status());
      }
      return send_block(setup.length);
    case DfuAction::kFinish:
      finish_pending_ = true;
      return {};
    case DfuAction::kAbort:
      services_->let_scan();
      finish_pending_ = false;
      uploaded_ = 0;
      return {};
    case DfuAction::kReplyState:
      reply_[0] = static_cast<std::byte>(at_.state);
      return {false, std::span(reply_).first(1)};
    case DfuAction::kReplyStatus:
    case DfuAction::kStartTimeout:
      return reply_status();
  }
  return stalled();
}

void UpdateDevice::take_block(const SetupPacket& setup, std::span<const std::byte> data) noexcept {
  if (data.size() > image::kDfuTransferSize || setup.value != next_block_) {
    return give_up(DfuStatus::kErrAddress);
  }
  if (const Checked<void> allowed = may_begin(); !allowed) return fail(allowed.error());
  ++next_block_;
  if (const Checked<void> taken = receiver_->take(data); !taken) return fail(taken.error());
}

Checked<void> UpdateDevice::may_begin() noexcept {
  if (!services_->hold_scans()) return refuse(Refusal::kBusyScanning);
  if (!services_->power_suffices()) return refuse(Refusal::kBattery);
  return {};
}

void UpdateDevice::fail(Refusal why) noexcept {
  last_error_ = static_cast<std::uint32_t>(why);
  give_up(image::dfu_status(why));
}

void UpdateDevice::give_up(DfuStatus why) noexcept {
  at_ = on_failure(why);
  finish_pending_ = false;
  services_->let_scan();
}

ControlReply UpdateDevice::send_block(std::uint16_t length) noexcept {
  const std::size_t n = std::min<std::size_t>(length, upload_.size() - uploaded_);
  const std::span<const std::byte> part = std::span<const std::byte>(upload_).subspan(uploaded_, n);
  uploaded_ = at_.state == DfuState::kIdle ? 0 : uploaded_ + n;
  return {false, part};
}

ControlReply UpdateDevice::reply_status() noexcept {
  const std::uint32_t poll_ms = at_.state == DfuState::kManifest ? kManifestMs : 0;
  reply_ = {static_cast<std::byte>(at_.status),
            static_cast<std::byte>(poll_ms & 0xFFU),
            static_cast<std::byte>((poll_ms >> 8U) & 0xFFU),
            static_cast<std::byte>((poll_ms >> 16U) & 0xFFU),
            static_cast<std::byte>(at_.state),
            std::byte{0}};
  return {false, reply_};
}

void UpdateDevice::work() noexcept {
  if (!work_pending()) return;
  const std::optional<Checked<void>> done = receiver_->finish_some();
  if (!done) return;
  finish_pending_ = false;
  allow_older_ = false;
  if (!*done) return fail(done->error());
  at_ = on_poll_timeout(at_, config_);
}

void UpdateDevice::bus_reset() noexcept {
  const std::optional<ControlBlock> block = control_.load();
  const bool bootable = block && std::any_of(block->slot.begin(), block->slot.end(),
                                             [](const SlotRecord& s) { return s.state == SlotState::kConfirmed; });
  at_ = on_bus_reset(at_, config_, bootable);
  services_->let_scan();
  finish_pending_ = false;
  uploaded_ = 0;
}

}  // namespace enamel::fw
