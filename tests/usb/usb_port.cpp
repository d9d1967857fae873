#include "tests/usb/usb_port.hpp"

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <stdexcept>

namespace enamel::test {
namespace {

constexpr std::uint32_t kRebootMs = 300;

/// Device, configuration, DFU interface, DFU functional descriptor (DFU 1.1 §4.2).
std::vector<std::uint8_t> descriptors(std::uint16_t bcd_device) {
  return {18,
          1,
          0x00,
          0x02,
          0,
          0,
          0,
          64,
          0x09,
          0x12,
          0x01,
          0x00,
          static_cast<std::uint8_t>(bcd_device & 0xFFU),
          static_cast<std::uint8_t>(bcd_device >> 8U),
          1,
          2,
          3,
          1,
          9,
          2,
          27,
          0,
          1,
          1,
          0,
          0x80,
          250,
          9,
          4,
          0,
          0,
          0,
          0xFE,
          1,
          2,
          0,
          9,
          0x21,
          0x07,
          0xE8,
          0x03,
          0x00,
          0x10,
          0x10,
          0x01};
}

std::string device_text(int number, const ProbeModel& probe) {
  const image::ImageVersion v = probe.status().version[*probe.running()];
  const auto bcd = static_cast<std::uint16_t>(v.major << 8U | v.minor);
  char id[16];
  std::snprintf(id, sizeof id, "%04x", bcd);
  const std::string n = std::to_string(number), address = std::to_string(number + 1);
  const std::string node = "bus/usb/001/00" + address;
  return "P: /devices/pci0000:00/0000:00:14.0/usb1/1-" + n + "\nN: " + node +
         "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nE: DEVNAME=/dev/" + node + "\nE: BUSNUM=001\nE: DEVNUM=00" +
         address + "\nE: MAJOR=189\nE: MINOR=" + n + "\nA: busnum=1\\n\nA: devnum=" + address +
         "\\n\nA: speed=480\\n\nA: bConfigurationValue=1\\n\nA: idVendor=1209\\n\nA: idProduct=0001\\n\nA: bcdDevice=" +
         id + "\\n\nA: serial=" + probe.options().serial + "\\n\nH: descriptors=" + to_hex(descriptors(bcd)) + "\n\n";
}

/// A string descriptor in UTF-16.
std::vector<std::byte> string_descriptor(const std::string& text) {
  std::vector<std::byte> out = {static_cast<std::byte>(2 + 2 * text.size()), std::byte{3}};
  for (const char c : text) {
    out.push_back(static_cast<std::byte>(c));
    out.push_back(std::byte{0});
  }
  return out;
}

}  // namespace

UsbPort::UsbPort(UMockdevTestbed* testbed, int number, const ProbeOptions& probe, const PortFaults& faults)
    : testbed_(testbed), number_(number), probe_(probe), faults_(faults) {
  syspath_ = "/sys/devices/pci0000:00/0000:00:14.0/usb1/1-" + std::to_string(number);
  devnode_ = "/dev/bus/usb/001/00" + std::to_string(number + 1);
  handler_ = umockdev_ioctl_base_new();
  g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(&UsbPort::on_ioctl), this);
  g_signal_connect(handler_, "client-vanished", G_CALLBACK(&UsbPort::on_vanished), this);
  plug_in();
}

UsbPort::~UsbPort() {
  if (plugged_) pull_out();
  g_object_unref(handler_);
}

void UsbPort::plug_in() {
  GError* error = nullptr;
  const std::string text = device_text(number_, probe_);
  if (!umockdev_testbed_add_from_string(testbed_, text.c_str(), &error)) throw std::runtime_error(error->message);
  if (!attached_ && !umockdev_testbed_attach_ioctl(testbed_, devnode_.c_str(), handler_, &error)) {
    throw std::runtime_error(error->message);
  }
  attached_ = true;
  plugged_ = true;
  umockdev_testbed_uevent(testbed_, syspath_.c_str(), "add");
}

void UsbPort::forget_transfers() {
  for (auto& [client, urbs] : done_) {
    for (UMockdevIoctlData* urb : urbs) umockdev_ioctl_data_unref(urb);
  }
  done_.clear();
}

void UsbPort::on_vanished(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
  auto& done = static_cast<UsbPort*>(self)->done_;
  const auto urbs = done.find(client);
  if (urbs == done.end()) return;
  for (UMockdevIoctlData* urb : urbs->second) umockdev_ioctl_data_unref(urb);
  done.erase(urbs);
}

void UsbPort::pull_out() {
  plugged_ = false;
  forget_transfers();
  // The handler stays: files that are still open get ENODEV, as from the kernel.
  umockdev_testbed_uevent(testbed_, syspath_.c_str(), "remove");
  umockdev_testbed_remove_device(testbed_, syspath_.c_str());
}

void UsbPort::later(std::uint32_t ms, GSourceFunc what) {
  // umockdev answers requests on a thread of its own; everything that changes a port stays on it.
  GSource* const source = g_timeout_source_new(ms);
  g_source_set_callback(source, what, this, nullptr);
  g_source_attach(source, g_source_get_context(g_main_current_source()));
  g_source_unref(source);
}

gboolean UsbPort::on_reboot(gpointer self) {
  auto* port = static_cast<UsbPort*>(self);
  port->pull_out();
  port->probe_.boot();
  port->later(kRebootMs, &UsbPort::on_return);
  return G_SOURCE_REMOVE;
}

gboolean UsbPort::on_return(gpointer self) {
  static_cast<UsbPort*>(self)->plug_in();
  return G_SOURCE_REMOVE;
}

gboolean UsbPort::on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
  return static_cast<UsbPort*>(self)->handle(client);
}

gboolean UsbPort::handle(UMockdevIoctlClient* client) {
  const gulong request = umockdev_ioctl_client_get_request(client);
  if (!plugged_) {
    umockdev_ioctl_client_complete(client, -1, ENODEV);
    return TRUE;
  }
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES: {
      UMockdevIoctlData* value =
          umockdev_ioctl_data_resolve(umockdev_ioctl_client_get_arg(client), 0, sizeof(std::uint32_t), nullptr);
      std::uint32_t capabilities = USBDEVFS_CAP_BULK_SCATTER_GATHER | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
      umockdev_ioctl_data_update(value, 0, reinterpret_cast<guint8*>(&capabilities), sizeof capabilities);
      umockdev_ioctl_data_unref(value);
      umockdev_ioctl_client_complete(client, 0, 0);
      return TRUE;
    }
    case USBDEVFS_RESET:
      probe_.bus_reset();
      umockdev_ioctl_client_complete(client, 0, 0);
      return TRUE;
    case USBDEVFS_CLAIMINTERFACE:
    case USBDEVFS_RELEASEINTERFACE:
    case USBDEVFS_SETINTERFACE:
    case USBDEVFS_SETCONFIGURATION:
    case USBDEVFS_DISCARDURB:
    case USBDEVFS_CLEAR_HALT:
      umockdev_ioctl_client_complete(client, 0, 0);
      return TRUE;
    case USBDEVFS_GETDRIVER:
      umockdev_ioctl_client_complete(client, -1, ENODATA);
      return TRUE;
    case USBDEVFS_SUBMITURB:
      return submit(client);
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY:
      return reap(client);
    default:
      umockdev_ioctl_client_complete(client, -1, ENOTTY);
      return TRUE;
  }
}

gboolean UsbPort::submit(UMockdevIoctlClient* client) {
  UMockdevIoctlData* urb_data =
      umockdev_ioctl_data_resolve(umockdev_ioctl_client_get_arg(client), 0, sizeof(usbdevfs_urb), nullptr);
  usbdevfs_urb urb{};
  std::memcpy(&urb, urb_data->data, sizeof urb);
  const auto size = static_cast<std::size_t>(urb.buffer_length);
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
  std::size_t length = 0;
  const int status = transfer(setup, data, length);
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
  probe_.work();
  if (probe_.take_reboot()) later(kRebootMs, &UsbPort::on_reboot);
  return TRUE;
}

gboolean UsbPort::reap(UMockdevIoctlClient* client) {
  std::deque<UMockdevIoctlData*>& finished = done_[client];
  if (finished.empty()) {
    umockdev_ioctl_client_complete(client, -1, EAGAIN);
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

bool UsbPort::faulty(const fw::SetupPacket& setup) {
  if (setup.request_type != 0x21 || setup.request != 1 || setup.length == 0) return false;
  ++blocks_;
  if (faults_.pull_at_block && blocks_ == *faults_.pull_at_block) {
    pull_out();
    if (faults_.replug_ms) later(*faults_.replug_ms, &UsbPort::on_return);
    return true;
  }
  if (faults_.stall_count > 0 && blocks_ >= faults_.stalls_at_block) {
    --faults_.stall_count;
    return true;
  }
  return false;
}

int UsbPort::transfer(const fw::SetupPacket& setup, std::span<std::byte> buffer, std::size_t& length) {
  if ((setup.request_type & 0x60U) == 0) return standard_request(setup, buffer, length);
  if (faulty(setup)) return -EPIPE;
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
  const std::array<std::string, 4> strings = {"", "enamel", "enamel probe", probe_.options().serial};
  const std::size_t index = setup.value & 0xFFU;
  if (index >= strings.size()) return -EPIPE;
  const std::vector<std::byte> reply =
      index == 0 ? std::vector<std::byte>{std::byte{4}, std::byte{3}, std::byte{9}, std::byte{4}}
                 : string_descriptor(strings[index]);
  length = std::min(reply.size(), buffer.size());
  std::copy_n(reply.begin(), length, buffer.begin());
  return 0;
}

}  // namespace enamel::test
