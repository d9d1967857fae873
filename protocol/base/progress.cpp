#include "protocol/base/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <iostream>
#include <utility>

namespace enamel {
namespace {

Progress::Target stderr_target() {
  return isatty(STDERR_FILENO) != 0 ? Progress::Target::kTerminal : Progress::Target::kLines;
}

std::string clock_text(double seconds) {
  const auto s = std::llround(seconds);
  if (s < 60) return fmt::format("{} s", s);
  return fmt::format("{}:{:02} min", s / 60, s % 60);
}

}  // namespace

Progress::Progress(const Clock& clock, std::string label, std::uint64_t total)
    : Progress(clock, std::move(label), total, std::cerr, stderr_target()) {}

Progress::Progress(const Clock& clock, std::string label, std::uint64_t total, std::ostream& out, Target target,
                   ProgressConfig config)
    : clock_(clock),
      label_(std::move(label)),
      total_(total),
      out_(out),
      target_(target),
      config_(config),
      start_(clock.now()),
      next_print_(start_ + (target == Target::kTerminal ? config.terminal_interval_ns : config.line_interval_ns)) {}

void Progress::update(std::uint64_t done) {
  if (finished_) return;
  done_ = done;
  const HostTime now = clock_.now();
  if (now < next_print_) return;
  next_print_ = now + (target_ == Target::kTerminal ? config_.terminal_interval_ns : config_.line_interval_ns);
  print(now, false);
}

void Progress::finish() {
  if (finished_) return;
  finished_ = true;
  print(clock_.now(), true);
}

void Progress::print(HostTime now, bool last) {
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  std::string line = label_ + ": " + std::to_string(done_);
  if (total_ > 0) {
    line += fmt::format("/{} ({} %)", total_, done_ >= total_ ? 100 : done_ * 100 / total_);
  }
  line += ", " + clock_text(elapsed_s);
  if (!last && total_ > done_ && done_ > 0) {
    const double left_s = elapsed_s / static_cast<double>(done_) * static_cast<double>(total_ - done_);
    line += ", " + clock_text(left_s) + " left";
  }
  // Terminal: return to the line's start and clear what the previous, longer text left behind.
  if (target_ == Target::kTerminal) {
    out_ << '\r' << line << "\x1b[K" << (last ? "\n" : "") << std::flush;
  } else {
    out_ << line << '\n' << std::flush;
  }
}

}  // namespace enamel
