// A table that is not where it says: found stop by stop while a scan is laid, named, and allowed for in the stops that
// follow, so that one lost step does not cost the scan.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/register/stops/slip_search.hpp"
#include "pipeline/register/stops/stop.hpp"

namespace enamel::pipeline {

/// What a stop's patch was found to be off from where the axes put it.
struct Slip {
  enum class Kind : std::uint8_t {
    kRotation,  ///< the turning axis stands further than it says, from here on: a lost step
    kSwing,     ///< the same of the swinging axis
    kModel,     ///< the model moved on the table
    kTable,     ///< table or head moved: bumped
    kOnce,      ///< this stop alone is off
  };
  std::size_t stop = 0;  ///< the first that shows it
  Kind kind = Kind::kModel;
  double rotation_deg = 0, swing_deg = 0;  ///< by which the axes would have to be off
  double rest_mm = 0;                      ///< what no angle explains
  [[nodiscard]] std::string text() const;  ///< one line for people, stops counted from 0
};

enum class Laid : std::uint8_t {
  kLaid,   ///< on one of those before it
  kAlone,  ///< overlaps none of those before it: nothing tells whether it slipped
  kNot,    ///< overlaps others by its angles, and fits none of them anywhere
};

struct FollowedStops {
  std::vector<Pose> T_model_cam;  ///< where each stop begins: by the axes, slips allowed for
  std::vector<AxesOffset> offsets;
  std::vector<Laid> laid;
  std::vector<double> deviation_mm;  ///< of each stop's surface from where the axes put it, as laid on those before
  std::vector<Slip> slips;
};

/// In the order in which they were taken. Deterministic, one thread.
[[nodiscard]] FollowedStops follow_stops(const std::vector<Stop>& stops, const calib::Mount& mount,
                                         const LayingRules& with, const SlipConfig& config);

}  // namespace enamel::pipeline
