#include "tests/usb/transfer_meter.hpp"

#include <ctime>

#include "protocol/base/clock.hpp"

namespace enamel::test {

TransferMeter::Reading TransferMeter::read() const {
  Reading now{SteadyClock().now(), 0};
  clockid_t cpu{};
  timespec t{};
  if (program_ > 0 && clock_getcpuclockid(program_, &cpu) == 0 && clock_gettime(cpu, &t) == 0) {
    now.cpu_ns = std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
  }
  return now;
}

void TransferMeter::on_block(std::uint16_t number, std::uint16_t length) {
  if (length == 0) {
    end_ = read();
  } else if (number == 0) {
    begin_ = read();
    end_.reset();
  }
}

std::optional<double> TransferMeter::wall_ms() const {
  if (!end_) return std::nullopt;
  return std::chrono::duration<double, std::milli>(end_->wall - begin_->wall).count();
}

std::optional<double> TransferMeter::cpu_ms() const {
  if (!end_) return std::nullopt;
  return static_cast<double>(end_->cpu_ns - begin_->cpu_ns) / 1e6;
}

}  // namespace enamel::test
