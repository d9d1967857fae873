#include "firmware/device/linux/dlpc347x/trigger_timing.hpp"

#include <fmt/core.h>

namespace enamel::fw {
namespace {

constexpr int kBlankLines = 25;  // of a frame, in which the sensor cannot expose

void must_fit(std::vector<std::string>& faults, const char* what, double needs_us, const char* in, double has_us) {
  if (needs_us <= has_us) return;
  faults.push_back(fmt::format("{} {:.0f} us, but {} {:.0f} us", what, needs_us, in, has_us));
}

}  // namespace

std::vector<std::string> timing_faults(const TriggerTiming& t) {
  const double pre = t.pattern.pre_us, illum = t.pattern.illum_us, post = t.pattern.post_us;
  const double dark_at = t.trigger_latency_us + pre + illum;
  std::vector<std::string> faults;
  // The light may come on as soon as the trigger does: its latency is at least 0.
  must_fit(faults, "the light must come on at the earliest after", t.margin_us, "comes on after", pre);
  must_fit(faults, "the pattern is over after", dark_at + t.margin_us, "the exposure ends after", t.exposure_us);
  must_fit(faults, "the projector is ready again after", dark_at + post, "the next strobe comes after",
           t.frame_us() - t.jitter_us);
  must_fit(faults, "the exposure takes", t.exposure_us, "the frame leaves", (t.frame_lines - kBlankLines) * t.line_us);
  return faults;
}

}  // namespace enamel::fw
