// Where the table should stand next: of all stops within the limits the one that shows most of what was not seen, or
// not seen well, for its time. A function of mount, rig, configuration and what it was told, in that order; no threads,
// one owner. Angles are rad in AxisAngles, degrees in the configuration; rotations are counted unwrapped.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calib/model/mount.hpp"
#include "calib/model/rig.hpp"
#include "pipeline/register/stops/seen_surface.hpp"
#include "pipeline/register/stops/view_forecast.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::pipeline {

struct PlannerConfig {
  double rot_from_deg = 0, rot_to_deg = 360;  ///< a whole turn ends one step earlier: it is where it began
  double rot_step_deg = 7.5;                  ///< chosen: half of the plan `full`
  double swing_from_deg = -30, swing_to_deg = 30, swing_step_deg = 10;
  double search_step_deg =
      20;  ///< derived: a picture is 13.5 mm high, 28 degrees of a circle of 27 mm: nothing between
  double max_incidence_deg = 75;   ///< derived: what is met flatter is not measured
  double good_incidence_deg = 50;  ///< chosen: better than this is not looked for
  double better_share = 0.1;       ///< chosen: what of a place's worth is being seen well, the rest being seen at all
  double cell_mm = 0.35;       ///< chosen: what lies between two teeth is not much wider; a third finer is 4x as slow
  double reach_mm = 9;         ///< derived: of a picture 13.5 mm high, 30 % overlap
  double min_overlap = 0.2;    ///< of a usual picture, so that a stop can be laid on what was seen
  double min_gain = 0.015;     ///< of a usual picture: chosen, see docs/desktop-scan.md
  double min_picture_mm2 = 5;  ///< chosen: a stop that shows less saw no model
  std::size_t max_stops = 96;  ///< chosen: a third more than the plan `full` has
  double stop_s = 3;           ///< chosen: what a stop counts beside its way, so that few stops come before short ways
  double speed_deg_per_s = 20;
};

enum class PlanEnd : std::uint8_t {
  kGoesOn,
  kComplete,     ///< no stop within the limits promises min_gain more
  kMaxStops,     ///< some stop does, but max_stops are taken
  kNothingSeen,  ///< a whole turn, or max_stops, and no model
};

struct PlanFigures {
  double seen_mm2 = 0;    ///< at max_incidence_deg or better
  double share_seen = 0;  ///< of that and what is believed to lie beyond, as far as some stop would show it; 0: nothing
  std::size_t stops = 0;
  PlanEnd end = PlanEnd::kGoesOn;
  [[nodiscard]] bool is_complete() const noexcept { return end == PlanEnd::kComplete; }
  [[nodiscard]] bool saw_nothing() const noexcept { return seen_mm2 <= 0; }
};

class StopPlanner {
 public:
  StopPlanner(const calib::Mount& mount, const calib::Rig& rig, const PlannerConfig& config);

  /// A stop was taken, asked for or not. `patch`: camera frame, table taken out; empty: it saw nothing.
  void seen(const calib::AxisAngles& angles, const SurfacePatch& patch);

  /// nullopt: what can be seen is seen, max_stops are taken, or a whole turn showed nothing. The same until seen().
  [[nodiscard]] std::optional<calib::AxisAngles> next() const { return next_; }
  [[nodiscard]] PlanFigures figures() const;

 private:
  struct Candidate {
    double rot_deg = 0, swing_deg = 0;
    Pose T_model_cam = Pose::Identity();
    bool is_taken = false;
  };
  struct Gain {
    double gain_mm2 = 0, overlap_mm2 = 0;
  };

  [[nodiscard]] std::vector<SeenPoint> points_of(const SurfacePatch& patch, const Pose& T_model_cam) const;
  void keep_depth(const SurfacePatch& patch, const Pose& T_model_cam);
  [[nodiscard]] bool is_void(const Vec3f& p_model) const;
  void count_vain(const Pose& T_model_cam);
  void mark_taken(const calib::AxisAngles& angles);
  [[nodiscard]] std::optional<calib::AxisAngles> search();
  [[nodiscard]] std::optional<calib::AxisAngles> plan();
  [[nodiscard]] Gain gain_of(const Candidate& candidate);
  [[nodiscard]] double worth(float cosine) const;
  [[nodiscard]] double usual_picture_mm2() const;
  [[nodiscard]] double cost_s(const Candidate& candidate) const;

  calib::Mount mount_;
  PlannerConfig config_;
  double least_cosine_, good_cosine_;
  double camera_px_mm_;  ///< of a camera pixel at the middle depth
  SeenSurface surface_;
  ViewForecast forecast_;
  std::vector<Candidate> candidates_;
  struct Depth {
    Eigen::Isometry3f T_cam_model;
    DepthBuffer nearest;
  };
  std::vector<Depth> depths_;           ///< of the stops so far
  std::vector<double> pictures_mm2_;    ///< that showed something
  std::vector<std::uint8_t> in_reach_;  ///< expected cells that some candidate would see
  std::vector<float> by_picture_;       ///< scratch of gain_of()
  std::optional<calib::AxisAngles> next_;
  double rot_deg_ = 0, swing_deg_ = 0;  ///< where the table stands
  double first_rot_deg_ = 0;
  std::size_t stops_ = 0;
  PlanEnd end_ = PlanEnd::kGoesOn;
};

}  // namespace enamel::pipeline
