// Time and processor time that a program needs for a download, from its first block to its last, seen from the device:
// the same measure for every program.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <optional>

#include "protocol/base/time.hpp"

namespace enamel::test {

class TransferMeter {
 public:
  struct Reading {
    HostTime wall{};
    std::int64_t cpu_ns = 0;  ///< of the program, all its threads, since it started
  };

  void watch(pid_t program) noexcept { program_ = program; }
  [[nodiscard]] pid_t program() const noexcept { return program_; }

  /// A block of a download arrives; length 0 ends it.
  void on_block(std::uint16_t number, std::uint16_t length);

  /// First block to end; nothing for a download that did not end. Of several downloads the last one counts.
  [[nodiscard]] std::optional<double> wall_ms() const;
  [[nodiscard]] std::optional<double> cpu_ms() const;

 private:
  [[nodiscard]] Reading read() const;
  std::atomic<pid_t> program_{0};
  std::optional<Reading> begin_, end_;
};

}  // namespace enamel::test
