#include "host/report/sight_report.hpp"

#include <fmt/format.h>

#include <string_view>

namespace enamel::host {
namespace {

constexpr double kUmPerMm = 1e3;
/// chosen: by judgement. Fewer in a scan are not worth a line.
constexpr std::uint64_t kFewestTold = 3;

std::string_view remedy(std::string_view trouble) {
  if (trouble == "glare") return ": dry there, or turn the probe";
  if (trouble == "metal") return ": turn the probe, or expose twice";
  if (trouble == "lamp") return ": turn the lamp away";
  if (trouble == "fog") return ": warm or wipe the window";
  return "";
}

}  // namespace

double SightTotals::lifted_um() const noexcept {
  return translucent_share > 0 ? kUmPerMm * lifted_mm / translucent_share : 0;
}

std::string sight_line(const SightTotals& totals) {
  std::string out;
  for (const auto& [trouble, bursts] : totals.bursts) {
    if (bursts < kFewestTold) continue;
    out += fmt::format("{}{} in {} bursts{}", out.empty() ? "" : "; ", trouble, bursts, remedy(trouble));
  }
  return out;
}

std::string translucency_line(const SightTotals& totals) {
  if (totals.translucent_bursts == 0) return "";
  return fmt::format("light from inside: surface lifted by {:.0f} um on average, one sigma {:.0f} um",
                     totals.lifted_um(), totals.left_sigma_um());
}

}  // namespace enamel::host
