// What the outline, the state's words and the distance bar say. No information by colour alone.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pipeline/types/preview.hpp"
#include "viewer/scene/colour.hpp"
#include "viewer/scene/probe_field.hpp"

namespace enamel::view {

struct StatusLine {
  Colour colour;
  std::string_view title;  ///< two or three words, upper case
  std::string hint;        ///< what to do, how far, or empty
};

/// A tracked burst that met less of the model than this is shown as weak.
inline constexpr double kWeakOverlap = 0.35;

[[nodiscard]] StatusLine status_line(const PreviewFrame& frame);

enum class DistanceZone { kNone, kTooNear, kNear, kOptimum, kFar, kTooFar };

struct DistanceReading {
  DistanceZone zone = DistanceZone::kNone;
  double position = 0;      ///< 0 = near end of the bar, 1 = far end, clamped
  double optimum_from = 0;  ///< the green part of the bar, 0…1
  double optimum_to = 1;
  Colour colour = kIdle;
  std::string_view words;  ///< "Move away", "Good distance", …
  std::string_view icon;   ///< one ASCII sign: "^" away from the teeth, "v" towards them, "o" good, "-" nothing seen
};

/// The bar spans the field and a quarter of it more at both ends, so that leaving the range shows as leaving the bar's
/// middle.
[[nodiscard]] DistanceReading distance_reading(double surface_distance_mm, const ProbeField& field) noexcept;

/// A stage of the pipeline in two lines and a bar.
struct StageLine {
  std::string name;
  std::string times;  ///< "67.1 / 149 ms"
  std::string rest;   ///< "9.9 /s, queue 0, most 1 of 1, waits for decode0"
  float busy = 0;     ///< share of the time, 0…1
};
[[nodiscard]] std::vector<StageLine> stage_lines(const PipelineFigures& figures);

/// 12345 -> "12 345"
[[nodiscard]] std::string grouped(std::uint64_t value);

}  // namespace enamel::view
