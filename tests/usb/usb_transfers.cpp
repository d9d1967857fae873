// Transfers of an emulated port: submitted, answered by the probe or by a planted fault, reaped.
#include <linux/usbdevice_fs.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <utility>

#include "tests/usb/usb_port.hpp"

namespace enamel::test {
namespace {

constexpr std::uint8_t kDnloadType = 0x21, kDnload = 1;

}  // namespace

gboolean UsbPort::submit(UMockdevIoctlClient* client) {
  UMockdevIoctlData* urb_data =
      umockdev_ioctl_data_resolve(umockdev_ioctl_client_get_arg(client), 0, sizeof(usbdevfs_urb), nullptr);
  int buffer_length = 0;
  std::memcpy(&buffer_length, urb_data->data + offsetof(usbdevfs_urb, buffer_length), sizeof buffer_length);
  const auto size = static_cast<std::size_t>(buffer_length);
  UMockdevIoctlData* buffer = umockdev_ioctl_data_resolve(urb_data, offsetof(usbdevfs_urb, buffer), size, nullptr);

  constexpr std::size_t kSetup = 8;
  fw::SetupPacket setup;
  std::memcpy(&setup.request_type, buffer->data, 1);
  std::memcpy(&setup.request, buffer->data + 1, 1);
  std::memcpy(&setup.value, buffer->data + 2, 2);
  std::memcpy(&setup.index, buffer->data + 4, 2);
  std::memcpy(&setup.length, buffer->data + 6, 2);
  std::vector<std::byte> data(size - kSetup);
  std::memcpy(data.data(), buffer->data + kSetup, data.size());
  const Fault fault = next_fault(setup);
  if (fault == Fault::kSilence) {
    umockdev_ioctl_data_unref(buffer);
    silent_[client].push_back(urb_data);
    umockdev_ioctl_client_complete(client, 0, 0);
    return TRUE;
  }
  std::size_t length = 0;
  const int status = fault == Fault::kStall || !plugged_ ? -EPIPE : transfer(setup, data, length);
  if (!plugged_) {
    umockdev_ioctl_data_unref(buffer);
    umockdev_ioctl_data_unref(urb_data);
    umockdev_ioctl_client_complete(client, -1, ENODEV);
    return TRUE;
  }
  if ((setup.request_type & 0x80U) != 0 && length > 0) {
    umockdev_ioctl_data_update(buffer, kSetup, reinterpret_cast<guint8*>(data.data()), static_cast<gint>(length));
  }
  int actual = static_cast<int>(length), told = status;
  umockdev_ioctl_data_update(urb_data, offsetof(usbdevfs_urb, status), reinterpret_cast<guint8*>(&told), sizeof told);
  umockdev_ioctl_data_update(urb_data, offsetof(usbdevfs_urb, actual_length), reinterpret_cast<guint8*>(&actual),
                             sizeof actual);
  umockdev_ioctl_data_unref(buffer);
  done_[client].push_back(urb_data);
  umockdev_ioctl_client_complete(client, 0, 0);
  if (probe_.work_pending() && !std::exchange(working_, true)) later(0, &UsbPort::on_work);
  if (probe_.take_reboot()) later(kRebootMs, &UsbPort::on_reboot);
  return TRUE;
}

gboolean UsbPort::reap(UMockdevIoctlClient* client) {
  std::deque<UMockdevIoctlData*>& finished = done_[client];
  if (finished.empty()) {
    umockdev_ioctl_client_complete(client, -1, open_.contains(client) ? EAGAIN : ENODEV);
    return TRUE;
  }
  UMockdevIoctlData* urb = finished.front();
  finished.pop_front();
  UMockdevIoctlData* target =
      umockdev_ioctl_data_resolve(umockdev_ioctl_client_get_arg(client), 0, sizeof(void*), nullptr);
  umockdev_ioctl_data_set_ptr(target, 0, urb);
  umockdev_ioctl_data_unref(target);
  umockdev_ioctl_data_unref(urb);
  umockdev_ioctl_client_complete(client, 0, 0);
  return TRUE;
}

gboolean UsbPort::discard(UMockdevIoctlClient* client) {
  // libusb gives a transfer up and then reaps it like any other (linux/usb/usbdevice_fs.h: status -ENOENT).
  end_silent(silent_[client], done_[client], -ENOENT);
  umockdev_ioctl_client_complete(client, 0, 0);
  return TRUE;
}

UsbPort::Fault UsbPort::next_fault(const fw::SetupPacket& setup) {
  if (setup.request_type != kDnloadType || setup.request != kDnload) return Fault::kNone;
  meter_.on_block(setup.value, setup.length);
  if (setup.length == 0) return Fault::kNone;
  ++blocks_;
  if (faults_.interrupt_at_block == blocks_) ::kill(meter_.program(), SIGINT);
  if (faults_.pull_at_block == blocks_) {
    pull_out();
    if (faults_.replug_ms) later(*faults_.replug_ms, &UsbPort::on_replug);
    return Fault::kNone;
  }
  if (faults_.stall_count > 0 && blocks_ >= faults_.stalls_at_block) {
    --faults_.stall_count;
    return Fault::kStall;
  }
  if (faults_.silent_count > 0 && blocks_ >= faults_.silent_at_block) {
    --faults_.silent_count;
    return Fault::kSilence;
  }
  return Fault::kNone;
}

int UsbPort::transfer(const fw::SetupPacket& setup, std::span<std::byte> buffer, std::size_t& length) {
  if ((setup.request_type & 0x60U) == 0) return standard_request(setup, buffer, length);
  const bool in = (setup.request_type & 0x80U) != 0;
  const fw::ControlReply reply = probe_.control(setup, in ? std::span<const std::byte>() : buffer);
  if (reply.stall) return -EPIPE;
  length = in ? std::min(reply.data.size(), buffer.size()) : buffer.size();
  if (in) std::copy_n(reply.data.begin(), length, buffer.begin());
  return 0;
}

int UsbPort::standard_request(const fw::SetupPacket& setup, std::span<std::byte> buffer, std::size_t& length) const {
  constexpr std::uint8_t kGetDescriptor = 6, kString = 3;
  if (setup.request != kGetDescriptor || (setup.value >> 8U) != kString) return -EPIPE;
  const std::vector<std::byte> reply = string_descriptor(identity(), setup.value & 0xFFU);
  if (reply.empty()) return -EPIPE;
  length = std::min(reply.size(), buffer.size());
  std::copy_n(reply.begin(), length, buffer.begin());
  return 0;
}

}  // namespace enamel::test
