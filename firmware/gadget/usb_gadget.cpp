#include "firmware/gadget/usb_gadget.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <vector>

namespace enamel::fw {
namespace {

/// An attribute of configfs takes its whole value in one write and knows no truncation.
Result<void> put(const std::string& path, std::string_view value) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (fd < 0) return fail(ErrorCode::kFileNotFound, path + ": " + std::strerror(errno));
  const bool whole = ::write(fd, value.data(), value.size()) == static_cast<ssize_t>(value.size());
  const int why = errno;
  ::close(fd);
  if (whole) return {};
  return fail(ErrorCode::kGadget, fmt::format("{} = {}: {}", path, value, std::strerror(why)));
}

Result<std::string> first_controller(const std::string& controllers) {
  std::vector<std::string> names;
  std::error_code ec;
  for (const auto& entry : std::filesystem::directory_iterator(controllers, ec))
    names.push_back(entry.path().filename());
  if (names.empty()) return fail(ErrorCode::kGadget, "no USB device controller in " + controllers);
  return *std::min_element(names.begin(), names.end());
}

}  // namespace

Result<void> connect_gadget(const std::string& folder, const UsbIdentity& identity, const std::string& serial,
                            const std::string& controllers) {
  ENAMEL_TRY(put(folder + "/idVendor", fmt::format("0x{:04x}", identity.vendor)));
  ENAMEL_TRY(put(folder + "/idProduct", fmt::format("0x{:04x}", identity.product)));
  ENAMEL_TRY(put(folder + "/bcdDevice", fmt::format("0x{:04x}", identity.bcd_device)));
  ENAMEL_TRY(put(folder + "/strings/0x409/serialnumber", serial));
  ENAMEL_TRY_ASSIGN(const std::string controller, first_controller(controllers));
  return put(folder + "/UDC", controller);
}

void disconnect_gadget(const std::string& folder) noexcept { static_cast<void>(put(folder + "/UDC", "\n")); }

}  // namespace enamel::fw
