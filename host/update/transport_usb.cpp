#include <libusb.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <mutex>

#include "host/update/probe_link.hpp"
#include "protocol/image/dfu.hpp"

namespace enamel::update {
namespace {

constexpr int kDfuInterface = 0;

LinkFault fault_of(int code) {
  switch (code) {
    case LIBUSB_ERROR_PIPE:
      return LinkFault::kStall;
    case LIBUSB_ERROR_TIMEOUT:
      return LinkFault::kTimeout;
    case LIBUSB_ERROR_NO_DEVICE:
    case LIBUSB_ERROR_NOT_FOUND:
      return LinkFault::kGone;
    case LIBUSB_ERROR_ACCESS:
      return LinkFault::kDenied;
    default:
      return LinkFault::kOther;
  }
}

int speed_mbit(libusb_device* device) {
  switch (libusb_get_device_speed(device)) {
    case LIBUSB_SPEED_LOW:
      return 1;
    case LIBUSB_SPEED_FULL:
      return 12;
    case LIBUSB_SPEED_HIGH:
      return 480;
    case LIBUSB_SPEED_SUPER:
      return 5000;
    default:
      return 0;
  }
}

std::string port_path(libusb_device* device) {
  std::array<std::uint8_t, 8> ports{};
  const int n = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
  std::string path = std::to_string(libusb_get_bus_number(device));
  for (int i = 0; i < n; ++i) path += (i == 0 ? "-" : ".") + std::to_string(ports[static_cast<std::size_t>(i)]);
  // Without a topology (some virtual hosts) the address is all there is.
  return n > 0 ? path : path + "-a" + std::to_string(libusb_get_device_address(device));
}

struct ExitContext {
  void operator()(libusb_context* context) const noexcept { libusb_exit(context); }
};
using Context = std::unique_ptr<libusb_context, ExitContext>;

Context make_context() {
  libusb_context* context = nullptr;
  return Context(libusb_init(&context) == 0 ? context : nullptr);
}

/// Calls visit for each probe until it says true.
void for_each_probe(libusb_context* context,
                    const std::function<bool(libusb_device*, const libusb_device_descriptor&)>& visit) {
  libusb_device** list = nullptr;
  const ssize_t n = libusb_get_device_list(context, &list);
  for (ssize_t i = 0; i < n; ++i) {
    libusb_device_descriptor d{};
    if (libusb_get_device_descriptor(list[i], &d) != 0 || d.idVendor != image::kUsbVendor) continue;
    if (d.idProduct != image::kUsbProduct && d.idProduct != image::kUsbProductRecovery) continue;
    if (visit(list[i], d)) break;
  }
  if (n >= 0) libusb_free_device_list(list, 1);
}

/// A control transfer that can be queued behind another; its buffer stays from one to the next.
class QueuedTransfer {
 public:
  QueuedTransfer() = default;
  ~QueuedTransfer() { libusb_free_transfer(transfer_); }
  QueuedTransfer(const QueuedTransfer&) = delete;
  QueuedTransfer& operator=(const QueuedTransfer&) = delete;

  /// `data` goes out; for an IN transfer it is empty and `length` bytes are asked for.
  Linked<void> submit(libusb_device_handle* handle, const ControlRequest& r, std::span<const std::byte> data,
                      std::uint16_t length, std::chrono::milliseconds timeout) {
    if (transfer_ == nullptr || length > image::kDfuTransferSize) return tl::unexpected(LinkFault::kOther);
    libusb_fill_control_setup(buffer_.data(), r.type, r.request, r.value, kDfuInterface, length);
    if (!data.empty()) std::memcpy(buffer_.data() + LIBUSB_CONTROL_SETUP_SIZE, data.data(), data.size());
    done_ = 0;
    libusb_fill_control_transfer(
        transfer_, handle, buffer_.data(), [](libusb_transfer* t) { *static_cast<int*>(t->user_data) = 1; }, &done_,
        static_cast<unsigned>(timeout.count()));
    const int code = libusb_submit_transfer(transfer_);
    if (code != 0) return tl::unexpected(fault_of(code));
    return {};
  }

  /// The bytes that were moved. Every transfer that was submitted has to be waited for.
  Linked<std::span<const std::byte>> wait(libusb_context* context) {
    while (done_ == 0) {
      const int code = libusb_handle_events_completed(context, &done_);
      if (code != 0 && code != LIBUSB_ERROR_INTERRUPTED) libusb_cancel_transfer(transfer_);
    }
    if (transfer_->status != LIBUSB_TRANSFER_COMPLETED) return tl::unexpected(fault_of(transfer_->status));
    return std::as_bytes(std::span(buffer_))
        .subspan(LIBUSB_CONTROL_SETUP_SIZE, static_cast<std::size_t>(transfer_->actual_length));
  }

 private:
  static LinkFault fault_of(libusb_transfer_status status) {
    switch (status) {
      case LIBUSB_TRANSFER_STALL:
        return LinkFault::kStall;
      case LIBUSB_TRANSFER_TIMED_OUT:
        return LinkFault::kTimeout;
      case LIBUSB_TRANSFER_NO_DEVICE:
        return LinkFault::kGone;
      default:
        return LinkFault::kOther;
    }
  }
  static LinkFault fault_of(int code) { return update::fault_of(code); }

  libusb_transfer* transfer_ = libusb_alloc_transfer(0);
  std::array<unsigned char, LIBUSB_CONTROL_SETUP_SIZE + image::kDfuTransferSize> buffer_{};
  int done_ = 1;
};

/// Has a context of its own, so that no other worker's thread handles this probe's transfers.
class UsbLink final : public ProbeLink {
 public:
  UsbLink(Context context, libusb_device_handle* handle) : context_(std::move(context)), handle_(handle) {}
  ~UsbLink() override {
    libusb_release_interface(handle_, kDfuInterface);
    libusb_close(handle_);
  }
  UsbLink(const UsbLink&) = delete;
  UsbLink& operator=(const UsbLink&) = delete;

  Linked<void> out(const ControlRequest& request, std::span<const std::byte> data,
                   std::chrono::milliseconds timeout) override {
    const auto submitted = first_.submit(handle_, request, data, static_cast<std::uint16_t>(data.size()), timeout);
    if (!submitted) return submitted;
    return whole(first_.wait(context_.get()), data.size());
  }

  Linked<std::vector<std::byte>> in(const ControlRequest& request, std::uint16_t length,
                                    std::chrono::milliseconds timeout) override {
    if (const auto submitted = second_.submit(handle_, request, {}, length, timeout); !submitted) {
      return tl::unexpected(submitted.error());
    }
    return copied(second_.wait(context_.get()));
  }

  Linked<std::vector<std::byte>> out_then_in(const ControlRequest& first, std::span<const std::byte> data,
                                             const ControlRequest& second, std::uint16_t length,
                                             std::chrono::milliseconds timeout) override {
    if (const auto submitted = first_.submit(handle_, first, data, static_cast<std::uint16_t>(data.size()), timeout);
        !submitted) {
      return tl::unexpected(submitted.error());
    }
    const auto behind = second_.submit(handle_, second, {}, length, timeout);
    const Linked<void> sent = whole(first_.wait(context_.get()), data.size());
    if (!behind) return tl::unexpected(sent ? behind.error() : sent.error());
    auto answer = copied(second_.wait(context_.get()));
    if (!sent) return tl::unexpected(sent.error());
    return answer;
  }

 private:
  static Linked<void> whole(const Linked<std::span<const std::byte>>& moved, std::size_t wanted) {
    if (!moved) return tl::unexpected(moved.error());
    if (moved->size() != wanted) return tl::unexpected(LinkFault::kOther);
    return {};
  }
  static Linked<std::vector<std::byte>> copied(const Linked<std::span<const std::byte>>& moved) {
    if (!moved) return tl::unexpected(moved.error());
    return std::vector<std::byte>(moved->begin(), moved->end());
  }

  Context context_;
  libusb_device_handle* handle_;
  QueuedTransfer first_, second_;
};

std::string read_string(libusb_device_handle* handle, std::uint8_t index) {
  std::array<unsigned char, 64> text{};
  const int n = libusb_get_string_descriptor_ascii(handle, index, text.data(), static_cast<int>(text.size()));
  return n > 0 ? std::string(reinterpret_cast<const char*>(text.data()), static_cast<std::size_t>(n)) : std::string();
}

Linked<void> open_interface(libusb_device* device, libusb_device_handle*& handle) {
  if (const int code = libusb_open(device, &handle); code != 0) return tl::unexpected(fault_of(code));
  const int code = libusb_claim_interface(handle, kDfuInterface);
  if (code == 0) return {};
  libusb_close(handle);
  return tl::unexpected(fault_of(code));
}

PortInfo describe(libusb_device* device, const libusb_device_descriptor& d, const std::string& port) {
  PortInfo info{port, {}, d.idProduct, d.bcdDevice, speed_mbit(device), false, {}};
  libusb_device_handle* handle = nullptr;
  const int code = libusb_open(device, &handle);
  info.denied = code == LIBUSB_ERROR_ACCESS;
  if (code != 0) return info;
  info.serial = read_string(handle, d.iSerialNumber);
  info.model = read_string(handle, d.iProduct);
  libusb_close(handle);
  return info;
}

class LibusbBus final : public UsbBus {
 public:
  std::vector<PortInfo> probes() override {
    std::vector<PortInfo> found = look([](const std::string&) { return true; });
    std::sort(found.begin(), found.end(), [](const PortInfo& a, const PortInfo& b) { return a.port < b.port; });
    return found;
  }

  std::optional<PortInfo> probe_at(const std::string& port) override {
    const std::vector<PortInfo> found = look([&](const std::string& p) { return p == port; });
    return found.empty() ? std::nullopt : std::optional(found.front());
  }

  Linked<std::unique_ptr<ProbeLink>> open(const std::string& port) override {
    const std::lock_guard lock(looking_);
    Context context = make_context();
    if (!context) return tl::unexpected(LinkFault::kOther);
    libusb_device_handle* handle = nullptr;
    Linked<void> opened = tl::unexpected(LinkFault::kGone);
    for_each_probe(context.get(), [&](libusb_device* device, const libusb_device_descriptor&) {
      if (port_path(device) != port) return false;
      opened = open_interface(device, handle);
      return true;
    });
    if (!opened) return tl::unexpected(opened.error());
    return std::make_unique<UsbLink>(std::move(context), handle);
  }

 private:
  /// Probes at the ports that are wanted; only these are opened, for their serials.
  std::vector<PortInfo> look(const std::function<bool(const std::string&)>& wanted) {
    const std::lock_guard lock(looking_);
    std::vector<PortInfo> found;
    const Context context = make_context();
    if (!context) return found;
    for_each_probe(context.get(), [&](libusb_device* device, const libusb_device_descriptor& d) {
      const std::string port = port_path(device);
      if (wanted(port)) found.push_back(describe(device, d, port));
      return false;
    });
    return found;
  }

  std::mutex looking_;  ///< two workers that look at once would open each other's probes
};

}  // namespace

bool PortInfo::recovery() const noexcept { return product == image::kUsbProductRecovery; }

std::string to_text(LinkFault fault) {
  switch (fault) {
    case LinkFault::kStall:
      return "the probe refused a request";
    case LinkFault::kTimeout:
      return "no answer in time";
    case LinkFault::kGone:
      return "the probe is gone";
    case LinkFault::kDenied:
      return "no permission";
    case LinkFault::kBusy:
      return "the probe does not finish";
    case LinkFault::kOther:
      break;
  }
  return "USB error";
}

std::unique_ptr<UsbBus> open_usb_bus() {
  if (!make_context()) return nullptr;
  return std::make_unique<LibusbBus>();
}

}  // namespace enamel::update
