#include "tests/usb/usb_port.hpp"

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace enamel::test {
namespace {

void unref_all(std::deque<UMockdevIoctlData*>& urbs) {
  for (UMockdevIoctlData* urb : urbs) umockdev_ioctl_data_unref(urb);
  urbs.clear();
}

/// The emulated tree is made for its owner alone. Here everybody may see it and reach umockdev; who may open the device
/// is for its mode to say.
void share_with_others(UMockdevTestbed* testbed, const std::string& node, mode_t mode) {
  const std::string root = umockdev_testbed_get_root_dir(testbed);
  const auto change = [&root](const std::string& path, mode_t to) {
    const std::string whole = root + path;
    if (::chmod(whole.c_str(), to) != 0) throw std::runtime_error("cannot change the mode of " + whole);
  };
  for (const std::string& path : {std::string(), std::string("/ioctl/_default"), "/ioctl" + node}) change(path, 0777);
  change(node, mode);
}

}  // namespace

UsbPort::UsbPort(UMockdevTestbed* testbed, int number, const ProbeOptions& probe, const PortFaults& faults)
    : testbed_(testbed), number_(number), probe_(probe), faults_(faults) {
  handler_ = umockdev_ioctl_base_new();
  g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(&UsbPort::on_ioctl), this);
  g_signal_connect(handler_, "client-connected", G_CALLBACK(&UsbPort::on_connected), this);
  g_signal_connect(handler_, "client-vanished", G_CALLBACK(&UsbPort::on_vanished), this);
  plug_in();
}

UsbPort::~UsbPort() {
  if (plugged_) pull_out();
  for (auto& [client, urbs] : done_) unref_all(urbs);
  g_object_unref(handler_);
}

UsbIdentity UsbPort::identity() const {
  const image::ImageVersion v = probe_.status().version[*probe_.running()];
  return {number_, static_cast<std::uint16_t>(v.major << 8U | v.minor), faults_.speed_mbit, probe_.options().serial};
}

void UsbPort::plug_in() {
  GError* error = nullptr;
  const std::string node = devnode(number_);
  if (!umockdev_testbed_add_from_string(testbed_, testbed_text(identity()).c_str(), &error)) {
    throw std::runtime_error(error->message);
  }
  if (attached_.insert(node).second && !umockdev_testbed_attach_ioctl(testbed_, node.c_str(), handler_, &error)) {
    throw std::runtime_error(error->message);
  }
  if (faults_.mode) share_with_others(testbed_, node, *faults_.mode);
  plugged_ = true;
  umockdev_testbed_uevent(testbed_, syspath(number_).c_str(), "add");
}

void UsbPort::end_silent(Urbs& silent, Urbs& done, int status) {
  for (UMockdevIoctlData* urb : silent) {
    umockdev_ioctl_data_update(urb, offsetof(usbdevfs_urb, status), reinterpret_cast<guint8*>(&status), sizeof status);
    done.push_back(urb);
  }
  silent.clear();
}

void UsbPort::forget(UMockdevIoctlClient* client) {
  open_.erase(client);
  for (auto* const pending : {&done_, &silent_}) {
    const auto urbs = pending->find(client);
    if (urbs == pending->end()) continue;
    unref_all(urbs->second);
    pending->erase(urbs);
  }
}

void UsbPort::on_connected(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
  auto* port = static_cast<UsbPort*>(self);
  port->forget(client);  // an earlier one at the same address
  if (port->plugged_) port->open_.insert(client);
}

void UsbPort::on_vanished(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
  static_cast<UsbPort*>(self)->forget(client);
}

void UsbPort::pull_out() {
  plugged_ = false;
  // As from the kernel: what files that are still open had submitted is there to be reaped, then they get ENODEV, also
  // when the probe is back (USBDEVFS_CAP_REAP_AFTER_DISCONNECT). libusb waits for each transfer that it submitted.
  for (auto& [client, urbs] : silent_) end_silent(urbs, done_[client], -ESHUTDOWN);
  open_.clear();
  umockdev_testbed_uevent(testbed_, syspath(number_).c_str(), "remove");
  umockdev_testbed_remove_device(testbed_, syspath(number_).c_str());
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

gboolean UsbPort::on_work(gpointer self) {
  auto* port = static_cast<UsbPort*>(self);
  port->probe_.work();
  port->working_ = port->probe_.work_pending();
  return port->working_ ? G_SOURCE_CONTINUE : G_SOURCE_REMOVE;
}

gboolean UsbPort::on_return(gpointer self) {
  static_cast<UsbPort*>(self)->plug_in();
  return G_SOURCE_REMOVE;
}

gboolean UsbPort::on_replug(gpointer self) {
  auto* port = static_cast<UsbPort*>(self);
  if (port->faults_.power_lost) {
    port->probe_.boot();
  } else {
    port->probe_.bus_reset();
  }
  port->number_ = port->faults_.replug_port.value_or(port->number_);
  port->plug_in();
  return G_SOURCE_REMOVE;
}

gboolean UsbPort::on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
  return static_cast<UsbPort*>(self)->handle(client);
}

gboolean UsbPort::handle(UMockdevIoctlClient* client) {
  const gulong request = umockdev_ioctl_client_get_request(client);
  if (request == USBDEVFS_REAPURB || request == USBDEVFS_REAPURBNDELAY) return reap(client);
  if (!open_.contains(client)) {
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
    case USBDEVFS_CLEAR_HALT:
      umockdev_ioctl_client_complete(client, 0, 0);
      return TRUE;
    case USBDEVFS_DISCARDURB:
      return discard(client);
    case USBDEVFS_GETDRIVER:
      umockdev_ioctl_client_complete(client, -1, ENODATA);
      return TRUE;
    case USBDEVFS_SUBMITURB:
      return submit(client);
    default:
      umockdev_ioctl_client_complete(client, -1, ENOTTY);
      return TRUE;
  }
}

}  // namespace enamel::test
