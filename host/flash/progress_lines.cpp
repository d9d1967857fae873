#include "host/flash/progress_lines.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>

namespace enamel::flash_app {
namespace {

constexpr int kBar = 25;  ///< characters that stand for everything
constexpr const char* kClearLine = "\r\033[K";

const char* name_of(update::Step step) {
  static constexpr std::array kNames = {"checking",   "sending",  "gone, waiting for it", "verifying", "restarting",
                                        "confirming", "confirmed"};
  return kNames[static_cast<std::size_t>(step)];
}

}  // namespace

ProgressLines::ProgressLines(const std::vector<update::PortInfo>& probes) : terminal_(::isatty(STDERR_FILENO) != 0) {
  for (const update::PortInfo& p : probes) rows_.push_back({.probe = p});
}

std::string ProgressLines::text(const Row& row) {
  const int done = std::max(row.percent, 0);
  const int bar = done * kBar / 100;
  std::array<char, 160> line{};
  std::snprintf(line.data(), line.size(), "%-8s %-16s [%s%s] %3d %% %s", row.probe.port.c_str(),
                row.probe.serial.c_str(), std::string(static_cast<std::size_t>(bar), '#').c_str(),
                std::string(static_cast<std::size_t>(kBar - bar), ' ').c_str(), done, name_of(row.step));
  return line.data() + (row.seconds_left > 1 ? ", " + std::to_string(row.seconds_left) + " s left" : std::string());
}

void ProgressLines::draw() {
  if (drawn_) std::fprintf(stderr, "\033[%zuA", rows_.size());
  for (const Row& row : rows_) std::fprintf(stderr, "%s%s\n", kClearLine, text(row).c_str());
  drawn_ = true;
}

void ProgressLines::tell(const update::PortInfo& probe, const update::FlashProgress& progress) {
  const auto row = std::find_if(rows_.begin(), rows_.end(), [&](const Row& r) { return r.probe.port == probe.port; });
  if (row == rows_.end()) return;
  const int percent = static_cast<int>(100 * progress.share);
  const bool new_step = row->percent < 0 || row->step != progress.step;
  if (!new_step && (!terminal_ || percent == row->percent)) return;
  row->percent = percent;
  row->step = progress.step;
  row->seconds_left = static_cast<int>(progress.seconds_left);
  if (terminal_) {
    draw();
  } else {
    std::fprintf(stderr, "%s\n", text(*row).c_str());
  }
}

void ProgressLines::note(const std::string& text) {
  if (drawn_) std::fprintf(stderr, "\033[%zuA", rows_.size());
  std::fprintf(stderr, "%s%s\n", terminal_ ? kClearLine : "", text.c_str());
  if (drawn_) {
    drawn_ = false;
    draw();
  }
}

}  // namespace enamel::flash_app
