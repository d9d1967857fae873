#include "firmware/device/linux/lines/pwm_heater.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>

#include "protocol/base/log.hpp"

namespace enamel::fw {
namespace {

/// 0, or errno. No allocation: the safety path comes here.
int put_number(const std::string& path, long value) noexcept {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (fd < 0) return errno;
  std::array<char, 24> text{};
  const char* const end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  const auto size = static_cast<std::size_t>(end - text.data());
  const int error = ::write(fd, text.data(), size) == static_cast<ssize_t>(size) ? 0 : errno;
  ::close(fd);
  return error;
}

tl::unexpected<Error> refused(const std::string& path, int error) {
  const char* const remedy = error == EACCES   ? "; no permission: add the user to the group that owns it"
                             : error == ENOENT ? "; there is no such output: enable the board's pwm overlay, then look "
                                                 "at /sys/class/pwm"
                             : error == EBUSY  ? "; another program has exported it"
                                               : "";
  return fail(ErrorCode::kBoardThermal, "heater " + path + ": " + std::strerror(error) + remedy);
}

/// ".../pwmchipN/pwmM" is there only after M was written to ".../pwmchipN/export".
int export_output(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) return 0;
  const std::string name = path.filename();
  int number = 0;
  if (name.rfind("pwm", 0) != 0 ||
      std::from_chars(name.data() + 3, name.data() + name.size(), number).ec != std::errc{}) {
    return ENOENT;
  }
  return put_number(path.parent_path() / "export", number);
}

}  // namespace

Result<std::unique_ptr<PwmHeater>> PwmHeater::open(const std::string& path, int period_us) {
  if (const int error = export_output(path); error != 0) return refused(path, error);
  std::unique_ptr<PwmHeater> heater(new PwmHeater(path, 1000L * period_us));
  // The kernel refuses a period shorter than the duty cycle, and any duty cycle before the first period.
  static_cast<void>(put_number(heater->duty_, 0));
  if (const int error = put_number(path + "/period", heater->period_ns_); error != 0) return refused(path, error);
  if (const int error = put_number(heater->duty_, 0); error != 0) return refused(path, error);
  if (const int error = put_number(heater->enable_, 1); error != 0) return refused(path, error);
  return heater;
}

PwmHeater::~PwmHeater() {
  set_power(0);
  static_cast<void>(put_number(enable_, 0));
}

void PwmHeater::set_power(std::uint16_t permille) noexcept {
  const int wanted = std::min<int>(permille, 1000);
  if (permille_.load(std::memory_order_acquire) == wanted) return;
  const int error = put_number(duty_, period_ns_ * wanted / 1000);
  permille_.store(error == 0 ? wanted : -1, std::memory_order_release);
  if (error != 0 && wanted == 0) log::error("heater", "cannot be driven: the thermal switch must cut it off");
}

}  // namespace enamel::fw
