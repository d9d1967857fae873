#include <fcntl.h>
#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "firmware/device/linux/dlpc347x/i2c_bus.hpp"

namespace enamel::fw {
namespace {

constexpr unsigned long kTimeout = 5;  // of the driver, in units of 10 ms
constexpr unsigned long kRetries = 1;

std::string remedy(int error) {
  switch (error) {
    case ENOENT:
      return "no such bus: is I2C switched on in the device tree?";
    case EPERM:
      return "denied by the service's sandbox: its unit needs DeviceAllow for it";
    case EACCES:
      return "no permission: add the user to the group i2c, or run as root";
    case ENXIO:
    case EREMOTEIO:
      return "nothing answers at that address: is the projector powered, are SDA and SCL the right way round?";
    case ETIMEDOUT:
      return "the bus hangs: a line is held low; switch the projector off and on";
    case EBUSY:
      return "a driver of the kernel has that address";
    default:
      return std::strerror(error);
  }
}

class I2cDev final : public I2cBus {
 public:
  I2cDev(int fd, std::string path, std::uint8_t address) : fd_(fd), path_(std::move(path)), address_(address) {}
  ~I2cDev() override { ::close(fd_); }
  I2cDev(const I2cDev&) = delete;
  I2cDev& operator=(const I2cDev&) = delete;

  [[nodiscard]] Result<void> write(std::span<const std::uint8_t> bytes) override {
    std::array<std::uint8_t, kMost> copy{};
    if (bytes.size() > copy.size()) return fail(ErrorCode::kInternal, "I2C: message too long");
    std::copy(bytes.begin(), bytes.end(), copy.begin());
    return transfer(0, std::span(copy).first(bytes.size()));
  }
  [[nodiscard]] Result<void> write_read(std::span<const std::uint8_t> bytes, std::span<std::uint8_t> answer) override {
    ENAMEL_TRY(write(bytes));
    return transfer(I2C_M_RD, answer);
  }

 private:
  static constexpr std::size_t kMost = 1100;  // a block of flash data, with its opcode

  [[nodiscard]] Result<void> transfer(std::uint16_t flags, std::span<std::uint8_t> bytes) {
    i2c_msg message{address_, flags, static_cast<std::uint16_t>(bytes.size()), bytes.data()};
    i2c_rdwr_ioctl_data data{&message, 1};
    if (::ioctl(fd_, I2C_RDWR, &data) == 1) return {};
    return fail(ErrorCode::kProjector, "projector on " + path_ + ": " + remedy(errno));
  }

  int fd_;
  std::string path_;
  std::uint8_t address_;
};

}  // namespace

Result<std::unique_ptr<I2cBus>> open_i2c(const std::string& path, std::uint8_t address) {
  const int fd = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (fd < 0) return fail(ErrorCode::kProjector, "projector on " + path + ": " + remedy(errno));
  unsigned long functions = 0;
  const bool plain = ::ioctl(fd, I2C_FUNCS, &functions) == 0 && (functions & I2C_FUNC_I2C) != 0;
  if (!plain || ::ioctl(fd, I2C_TIMEOUT, kTimeout) != 0 || ::ioctl(fd, I2C_RETRIES, kRetries) != 0) {
    ::close(fd);
    return fail(ErrorCode::kProjector, "projector on " + path + ": no I2C bus that takes plain messages");
  }
  return std::unique_ptr<I2cBus>(std::make_unique<I2cDev>(fd, path, address));
}

}  // namespace enamel::fw
