#include <fcntl.h>
#include <fmt/core.h>
#include <linux/hidraw.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <vector>

#include "firmware/device/linux/dlpc350/hid_port.hpp"

namespace enamel::fw {
namespace {

namespace fs = std::filesystem;

constexpr unsigned kTexasInstruments = 0x0451, kDlpc350 = 0x6401;
constexpr int kSignals = 3;  // that may interrupt a wait

std::string remedy(int error) {
  switch (error) {
    case ENOENT:
      return "no such device: is the projector powered and its USB cable plugged in?";
    case EPERM:
      return "denied by the service's sandbox: its unit needs DeviceAllow for it";
    case EACCES:
      return "no permission: add a udev rule SUBSYSTEM==\"hidraw\", ATTRS{idVendor}==\"0451\", "
             "ATTRS{idProduct}==\"6401\", TAG+=\"uaccess\", then plug it in again";
    case ENODEV:
    case EIO:
    case EPIPE:
      return "unplugged or switched off: plug it in and start again";
    case ETIMEDOUT:
      return "it takes no message: switch the projector off and on";
    default:
      return std::strerror(error);
  }
}

tl::unexpected<Error> failed(const std::string& path, const std::string& why) {
  return fail(ErrorCode::kProjector, "projector on " + path + ": " + why);
}

class Hidraw final : public HidPort {
 public:
  Hidraw(int fd, std::string path) : fd_(fd), path_(std::move(path)) {}
  ~Hidraw() override { ::close(fd_); }
  Hidraw(const Hidraw&) = delete;
  Hidraw& operator=(const Hidraw&) = delete;

  [[nodiscard]] Result<void> write(const HidReport& report) override {
    std::array<std::uint8_t, 1 + std::tuple_size_v<HidReport>> numbered{};  // the kernel wants the report id first
    std::copy(report.begin(), report.end(), numbered.begin() + 1);
    const ssize_t n = ::write(fd_, numbered.data(), numbered.size());
    if (n == static_cast<ssize_t>(numbered.size())) return {};
    return failed(path_, remedy(n < 0 ? errno : EIO));
  }

  [[nodiscard]] Result<std::size_t> read(HidReport& report, Nanoseconds limit) override {
    pollfd wanted{fd_, POLLIN, 0};
    int ready = -1;
    for (int i = 0; i < kSignals && ready < 0; ++i) {
      ready = ::poll(&wanted, 1, static_cast<int>(limit.count() / 1'000'000));
      if (ready < 0 && errno != EINTR) break;
    }
    if (ready == 0) return std::size_t{0};
    if (ready < 0 || (wanted.revents & POLLIN) == 0) return failed(path_, remedy(ready < 0 ? errno : ENODEV));
    const ssize_t n = ::read(fd_, report.data(), report.size());
    if (n <= 0) return failed(path_, remedy(n < 0 ? errno : ENODEV));
    return static_cast<std::size_t>(n);
  }

 private:
  int fd_;
  std::string path_;
};

Result<std::unique_ptr<HidPort>> open_one(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (fd < 0) return failed(path, remedy(errno));
  auto port = std::make_unique<Hidraw>(fd, path);
  hidraw_devinfo info{};
  if (::ioctl(fd, HIDIOCGRAWINFO, &info) != 0) return failed(path, "no HID device");
  const unsigned vendor = static_cast<std::uint16_t>(info.vendor), product = static_cast<std::uint16_t>(info.product);
  if (vendor == kTexasInstruments && product == kDlpc350) return std::unique_ptr<HidPort>(std::move(port));
  return failed(path, fmt::format("{:04x}:{:04x} is no LightCrafter 4500, which is {:04x}:{:04x}", vendor, product,
                                  kTexasInstruments, kDlpc350));
}

/// What the kernel says of it, which needs no permission. A LightCrafter 4500 is more than one HID device: commands go
/// to its first interface.
bool is_wanted(const fs::path& device) {
  std::error_code none;
  const std::string place = fs::read_symlink(device, none).string();
  const std::size_t id = place.find(fmt::format(":{:04X}:{:04X}.", kTexasInstruments, kDlpc350));
  return id != std::string::npos && place.rfind(":1.0/", id) != std::string::npos;
}

Result<std::unique_ptr<HidPort>> open_any() {
  std::error_code none;
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator("/sys/class/hidraw", none)) {
    if (is_wanted(entry.path())) found.push_back("/dev/" + entry.path().filename().string());
  }
  if (found.empty()) {
    return fail(ErrorCode::kProjector,
                "projector: no LightCrafter 4500 (0451:6401) on USB: is it powered and its cable plugged in?");
  }
  return open_one(*std::min_element(found.begin(), found.end()));
}

}  // namespace

Result<std::unique_ptr<HidPort>> open_hidraw(const std::string& path) {
  return path == "any" ? open_any() : open_one(path);
}

}  // namespace enamel::fw
