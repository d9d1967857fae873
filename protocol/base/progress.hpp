// Progress of long work on stderr: one updating line on a terminal, otherwise one line about every two seconds.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

#include "protocol/base/clock.hpp"

namespace enamel {

struct ProgressConfig {
  Nanoseconds terminal_interval_ns{100'000'000};
  Nanoseconds line_interval_ns{2'000'000'000};
};

/// Counts to `total` (0: unknown, then no percentage and no ETA). One thread at a time.
class Progress {
 public:
  enum class Target : std::uint8_t { kTerminal, kLines };

  /// To stderr, in the style that stderr is.
  Progress(const Clock& clock, std::string label, std::uint64_t total);
  Progress(const Clock& clock, std::string label, std::uint64_t total, std::ostream& out, Target target,
           ProgressConfig config = {});
  ~Progress() { finish(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void update(std::uint64_t done);
  void advance(std::uint64_t by = 1) { update(done_ + by); }
  /// Writes the last line; later calls do nothing. Called by the destructor.
  void finish();

 private:
  void print(HostTime now, bool last);

  const Clock& clock_;
  std::string label_;
  std::uint64_t total_;
  std::uint64_t done_ = 0;
  std::ostream& out_;
  Target target_;
  ProgressConfig config_;
  HostTime start_;
  HostTime next_print_;
  bool finished_ = false;
};

}  // namespace enamel
