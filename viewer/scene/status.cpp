#include "viewer/scene/status.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string_view>

namespace enamel::view {
namespace {

/// 9.87 -> "9.9", 149.2 -> "149"
std::string three_digits(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), value < 99.95 ? "%.1f" : "%.0f", value);
  return text.data();
}

/// Of a burst from which no surface came.
StatusLine rejected_line(std::string_view why) {
  if (why == "too_fast") return {kBad, "TOO FAST", "Move slower"};
  if (why == "saturated") return {kBad, "TOO BRIGHT", "Dry here, turn the lamp away, or turn the probe"};
  if (why == "other_light") return {kBad, "OTHER LIGHT", "Turn the lamp away"};
  if (why == "no_fringes") return {kBad, "NO FRINGES", "Turn the lamp away, wipe the window"};
  return {kBad, "NO SURFACE", "Hold the probe over a tooth"};
}

/// What is in the way of a surface that is tracked all the same; nothing where nothing is.
std::optional<StatusLine> sight_line(SightTrouble trouble) {
  switch (trouble) {
    case SightTrouble::kGlare:
      return StatusLine{kWeak, "GLARE", "Dry here, or turn the probe"};
    case SightTrouble::kMetal:
      return StatusLine{kWeak, "METAL", "Turn the probe, or expose twice"};
    case SightTrouble::kLamp:
      return StatusLine{kWeak, "OTHER LIGHT", "Turn the lamp away"};
    case SightTrouble::kFog:
      return StatusLine{kWeak, "FOGGED", "Warm or wipe the window"};
    case SightTrouble::kNone:
      break;
  }
  return std::nullopt;
}

StatusLine tracking_line(const PreviewFrame& frame) {
  if (!frame.placed) {
    return {kIdle, "READY", "Hold the probe over a tooth"};
  }
  if (frame.segment != kModelSegment) {
    return {kViolet, "NEW PLACE", "Kept apart: go on, or return to the place shown"};
  }
  switch (frame.track) {
    case TrackState::kLost:
      return rejected_line(frame.rejected);
    case TrackState::kRelocalised:
      return {kWeak, "JOINED TO THE MODEL", "Stay here for a moment"};
    case TrackState::kStarted:
    case TrackState::kTracking:
      break;
  }
  if (frame.undetermined) {
    return {kWeak, "TOO SMOOTH", "Nothing here tells where: keep an edge, a fold or a tooth in view"};
  }
  if (frame.track_overlap < kWeakOverlap) {  // false for NaN: unknown is not weak
    return {kWeak, "TRACKING WEAK", "Move slower, keep the model in view"};
  }
  return sight_line(frame.sight.trouble).value_or(StatusLine{kGood, "TRACKING", ""});
}

}  // namespace

StatusLine status_line(const PreviewFrame& frame) {
  switch (frame.state) {
    case ScanState::kWaitingForProbe:
      return {kIdle, "WAITING FOR PROBE", "Switch the probe on"};
    case ScanState::kPaused:
      return {kAccent, "PAUSED", "Space continues"};
    case ScanState::kProbeLost:
      return {kBad, "PROBE LOST", "Reconnect the probe; the model is kept"};
    case ScanState::kRefining:
      return {kAccent, "REFINING THE MODEL", three_digits(100 * frame.refined) + " %"};
    case ScanState::kFinished:
      return {kAccent, "SCAN FINISHED", frame.result};
    case ScanState::kScanning:
      break;
  }
  return tracking_line(frame);
}

DistanceReading distance_reading(double surface_distance_mm, const ProbeField& field) noexcept {
  const double range_mm = field.far_mm - field.near_mm;
  const double from_mm = field.near_mm - 0.25 * range_mm;
  const double span_mm = 1.5 * range_mm;
  const auto on_bar = [&](double mm) { return std::clamp((mm - from_mm) / span_mm, 0.0, 1.0); };
  DistanceReading out;
  out.optimum_from = on_bar(field.optimum_near_mm);
  out.optimum_to = on_bar(field.optimum_far_mm);
  out.words = "No surface";
  out.icon = "-";
  if (!std::isfinite(surface_distance_mm) || !(range_mm > 0)) {
    return out;
  }
  out.position = on_bar(surface_distance_mm);
  const auto say = [&out](DistanceZone zone, Colour colour, std::string_view words, std::string_view icon) {
    out.zone = zone;
    out.colour = colour;
    out.words = words;
    out.icon = icon;
    return out;
  };
  if (surface_distance_mm < field.near_mm) {
    return say(DistanceZone::kTooNear, kBad, "Too near", "^");
  }
  if (surface_distance_mm < field.optimum_near_mm) {
    return say(DistanceZone::kNear, kWeak, "Move away", "^");
  }
  if (surface_distance_mm <= field.optimum_far_mm) {
    return say(DistanceZone::kOptimum, kGood, "Good distance", "o");
  }
  if (surface_distance_mm <= field.far_mm) {
    return say(DistanceZone::kFar, kAccent, "Move closer", "v");
  }
  return say(DistanceZone::kTooFar, kViolet, "Too far", "v");
}

std::vector<StageLine> stage_lines(const PipelineFigures& figures) {
  std::vector<StageLine> lines;
  for (const StageFigures& stage : figures.stages) {
    const double busy = std::isfinite(stage.busy) ? std::clamp(stage.busy, 0.0, 1.0) : 0.0;
    const std::string waits = stage.waits_for.empty() ? "" : ", waits for " + stage.waits_for;
    lines.push_back({stage.name, three_digits(stage.median_ms) + " / " + three_digits(stage.p95_ms) + " ms",
                     three_digits(stage.rate_hz) + " /s, queue " + std::to_string(stage.queue_depth) + ", most " +
                         std::to_string(stage.queue_high_water) + " of " + std::to_string(stage.queue_capacity) + waits,
                     static_cast<float>(busy)});
  }
  return lines;
}

std::string grouped(std::uint64_t value) {
  std::string digits = std::to_string(value);
  for (std::size_t at = digits.size(); at > 3;) {
    at -= 3;
    digits.insert(at, 1, ' ');
  }
  return digits;
}

}  // namespace enamel::view
