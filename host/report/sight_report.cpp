#include "host/report/sight_report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string_view>

namespace enamel::host {
namespace {

constexpr double kUmPerMm = 1e3;
/// chosen: by judgement. Fewer in a scan are not worth a line.
constexpr std::uint64_t kFewestTold = 3;

std::string_view remedy(SightTrouble trouble) {
  switch (trouble) {
    case SightTrouble::kGlare:
      return "dry there, or turn the probe";
    case SightTrouble::kMetal:
      return "turn the probe, or expose twice";
    case SightTrouble::kLamp:
      return "turn the lamp away";
    case SightTrouble::kFog:
      return "warm or wipe the window";
    case SightTrouble::kNone:
      break;
  }
  return "";
}

}  // namespace

void SightTotals::add(const Sight& sight) noexcept {
  ++bursts[static_cast<std::size_t>(sight.trouble)];
  if (!(sight.apparent_depth_mm > 0)) return;
  ++translucent_bursts;
  translucent_share += static_cast<double>(sight.translucent_share);
  apparent_depth_mm += static_cast<double>(sight.translucent_share * sight.apparent_depth_mm);
}

double SightTotals::apparent_depth_um() const noexcept {
  return translucent_share > 0 ? kUmPerMm * apparent_depth_mm / translucent_share : 0;
}

double SightTotals::left_um() const noexcept { return kApparentDepthUnsure * apparent_depth_um(); }

std::string sight_json(const SightTotals& totals) {
  nlohmann::json bursts = nlohmann::json::object();
  for (std::size_t t = 1; t < kSightTroubles; ++t) bursts[std::string(kSightTroubleNames[t])] = totals.bursts[t];
  const double share =
      totals.translucent_bursts > 0 ? totals.translucent_share / static_cast<double>(totals.translucent_bursts) : 0;
  const nlohmann::json out = {{"bursts", bursts},
                              {"translucency",
                               {{"bursts", totals.translucent_bursts},
                                {"share_of_surface", share},
                                {"lifted_um", totals.apparent_depth_um()},
                                {"left_sigma_um", totals.left_um()}}}};
  return out.dump();
}

std::string sight_line(const SightTotals& totals) {
  std::string out;
  for (std::size_t t = 1; t < kSightTroubles; ++t) {
    if (totals.bursts[t] < kFewestTold) continue;
    out += fmt::format("{}{} in {} bursts: {}", out.empty() ? "" : "; ", kSightTroubleNames[t], totals.bursts[t],
                       remedy(static_cast<SightTrouble>(t)));
  }
  return out;
}

std::string translucency_line(const SightTotals& totals) {
  if (totals.translucent_bursts == 0) return "";
  return fmt::format("light from inside: surface lifted by {:.0f} um on average, one sigma {:.0f} um",
                     totals.apparent_depth_um(), totals.left_um());
}

}  // namespace enamel::host
