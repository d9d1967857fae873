// What can be wrong with a finished scan, in the nine classes that dental laboratories reject by.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/types/geometry.hpp"

namespace enamel::host {

enum class DefectClass : std::uint8_t {
  kHole,         ///< a place within the scanned surface that no burst measured
  kStitching,    ///< passes that cannot be laid on each other
  kTissue,       ///< something passed before the surface: tongue, cheek, glove
  kReliability,  ///< surface that few bursts saw
  kScanBody,     ///< a scan body that is not as its maker says
  kHumidity,     ///< mirror light of something wet
  kBridge,       ///< a web across a gap
  kFinishLine,   ///< the edge of a prepared tooth is blurred
  kNoise,        ///< rough surface
};
inline constexpr std::size_t kDefectClasses = 9;

inline constexpr std::array<std::string_view, kDefectClasses> kDefectNames = {
    "mesh hole", "stitching",         "tissue", "reliability", "scan-body geometry", "humidity",
    "bridge",    "fuzzy finish line", "noise"};
[[nodiscard]] constexpr std::string_view name_of(DefectClass c) noexcept {
  return kDefectNames[static_cast<std::size_t>(c)];
}

struct Defect {
  DefectClass kind = DefectClass::kHole;
  Vec3d p_model_mm = Vec3d::Zero();  ///< a place on the surface, in the middle of it
  double size_mm2 = 0;               ///< area
  double value = 0;                  ///< what told it, …
  double limit = 0;                  ///< … told beyond this. Unit: unit_of()
  double confidence = 0;             ///< 0.5 at the limit … 1
  std::string words = {};            ///< what is wrong, what to do
};

/// Of Defect::value and limit: "mm2", "um", "views", …
[[nodiscard]] std::string_view unit_of(DefectClass c) noexcept;

/// From how far a value lies beyond its limit, as their ratio, 1 and more: ratio / (1 + ratio).
[[nodiscard]] double confidence_of(double ratio) noexcept;

/// "scan-body geometry at (1.2, -3.4, 48.0), 2.1 mm2: …"
[[nodiscard]] std::string defect_line(const Defect& defect);

/// Array of objects with the keys class, p_model_mm, size_mm2, value, limit, unit, confidence, words.
[[nodiscard]] std::string defects_json(const std::vector<Defect>& defects);

/// "1 mesh hole, 2 bridge", or empty.
[[nodiscard]] std::string defects_summary(const std::vector<Defect>& defects);

}  // namespace enamel::host
