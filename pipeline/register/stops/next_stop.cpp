#include "pipeline/register/stops/next_stop.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/register/stops/mount_prior.hpp"

namespace enamel::pipeline {
namespace {

constexpr double kTurn_deg = 360;
constexpr double kSameStop_deg = 0.05;  // of two stops: what an axis is off by, and less than any grid
constexpr double kVoid_mm = 1;          // a surface so far behind a place shows that nothing is there
constexpr float kAsForetold = 0.1F;     // chosen: of a cosine: as good as was foretold
constexpr float kAskedWeight = 0.03F;   // five stops in vain: no longer asked
constexpr double kPointsACell = 3;      // along an edge of a cell of what faces the camera
constexpr std::uint8_t kMostVain = 30;  // 2^-30 of an area is none

calib::AxisAngles stop_angles(double rot_deg, double swing_deg) {
  calib::AxisAngles out;
  out.rotation_command = rot_deg * calib::kRadPerDegree;
  out.swing_command = swing_deg * calib::kRadPerDegree;
  return out;
}

/// From, from + step … up to `to`; not the whole turn's end.
std::vector<double> angle_grid(double from, double to, double step) {
  std::vector<double> out;
  const auto count = static_cast<int>(std::floor((to - from) / step + 1e-9));
  for (int n = 0; n <= count; ++n) {
    const double angle = from + n * step;
    if (angle - from < kTurn_deg - kSameStop_deg) out.push_back(angle);
  }
  return out;
}

double nearest_to_zero(double from, double to) { return std::clamp(0.0, from, to); }

}  // namespace

StopPlanner::StopPlanner(const calib::Mount& mount, const calib::Rig& rig, const PlannerConfig& config)
    : mount_(mount),
      config_(config),
      least_cosine_(std::cos(config.max_incidence_deg * calib::kRadPerDegree)),
      good_cosine_(std::cos(config.good_incidence_deg * calib::kRadPerDegree)),
      camera_px_mm_(calib::middle_depth_mm(rig) / rig.camera.fx),
      surface_(config.cell_mm, config.reach_mm),
      forecast_(rig, config.cell_mm, least_cosine_),
      first_rot_deg_(config.rot_from_deg) {
  for (const double rot : angle_grid(config.rot_from_deg, config.rot_to_deg, config.rot_step_deg)) {
    for (const double swing : angle_grid(config.swing_from_deg, config.swing_to_deg, config.swing_step_deg)) {
      candidates_.push_back({rot, swing, pose_by_axes(mount, stop_angles(rot, swing))});
    }
  }
  rot_deg_ = config.rot_from_deg;
  swing_deg_ = nearest_to_zero(config.swing_from_deg, config.swing_to_deg);
  if (config.max_stops > 0) next_ = stop_angles(rot_deg_, swing_deg_);
}

std::vector<SeenPoint> StopPlanner::points_of(const SurfacePatch& patch, const Pose& T_model_cam) const {
  const Eigen::Isometry3f T = T_model_cam.cast<float>();
  const int stride = std::max(1, static_cast<int>(config_.cell_mm / (kPointsACell * camera_px_mm_)));
  std::vector<SeenPoint> out;
  for (int v = stride / 2; v < patch.points.height(); v += stride) {
    for (int u = stride / 2; u < patch.points.width(); u += stride) {
      const Vec3f &p = patch.points(u, v), &n = patch.normals(u, v);
      if (!p.allFinite() || !n.allFinite()) continue;
      out.push_back({T * p, T.linear() * n, forecast_.cosine_of(p, n)});
    }
  }
  return out;
}

void StopPlanner::keep_depth(const SurfacePatch& patch, const Pose& T_model_cam) {
  Depth depth{T_model_cam.inverse().cast<float>(), forecast_.picture()};
  depth.nearest.clear();
  for (const Vec3f& p : patch.points.pixels()) {
    if (!p.allFinite()) continue;
    const std::size_t cell = depth.nearest.at(p);
    if (cell != DepthBuffer::kOutside) depth.nearest.put(cell, p.z());
  }
  depths_.push_back(std::move(depth));
}

bool StopPlanner::is_void(const Vec3f& p_model) const {
  return std::any_of(depths_.begin(), depths_.end(), [&](const Depth& d) {
    const Vec3f p = d.T_cam_model * p_model;
    const std::size_t cell = d.nearest.at(p);
    return cell != DepthBuffer::kOutside && !d.nearest.is_empty(cell) &&
           d.nearest.nearest(cell) > p.z() + static_cast<float>(kVoid_mm);
  });
}

/// What this stop should have shown by all that is known now, and did not.
void StopPlanner::count_vain(const Pose& T_model_cam) {
  forecast_.look_from(T_model_cam, surface_.cells());
  double picture_mm2 = 0;
  for (const ViewForecast::View& view : forecast_.seen()) {
    const SeenCell& cell = surface_.cells()[view.cell];
    picture_mm2 += static_cast<double>(cell.area_mm2);
    if (cell.cosine < view.cosine - kAsForetold && cell.vain < kMostVain) surface_.cell_in_vain(view.cell);
  }
  if (picture_mm2 >= config_.min_picture_mm2) pictures_mm2_.push_back(picture_mm2);
  std::size_t at = 0;
  for (std::size_t n = 0; n < surface_.expected().size(); ++n) {
    const ExpectedCell& e = surface_.expected()[n];
    if (forecast_.look_at(e.point, e.normal, at) > 0) surface_.expected_in_vain(n);
  }
}

void StopPlanner::mark_taken(const calib::AxisAngles& angles) {
  rot_deg_ = angles.rotation() * calib::kDegreesPerRad;
  swing_deg_ = angles.swing() * calib::kDegreesPerRad;
  if (stops_ == 0) first_rot_deg_ = rot_deg_;
  ++stops_;
  for (Candidate& c : candidates_) {
    const double turn = std::remainder(c.rot_deg - rot_deg_, kTurn_deg);
    if (std::abs(turn) < kSameStop_deg && std::abs(c.swing_deg - swing_deg_) < kSameStop_deg) c.is_taken = true;
  }
}

void StopPlanner::seen(const calib::AxisAngles& angles, const SurfacePatch& patch) {
  mark_taken(angles);
  const Pose T_model_cam = pose_by_axes(mount_, angles);
  surface_.add(points_of(patch, T_model_cam));
  keep_depth(patch, T_model_cam);
  surface_.expect([&](const Vec3f& p) { return is_void(p); });
  count_vain(T_model_cam);
  in_reach_.assign(surface_.expected().size(), 0);
  next_ = pictures_mm2_.empty() ? search() : plan();
}

/// On from where it began, and what is left before that, until all round was looked at.
std::optional<calib::AxisAngles> StopPlanner::search() {
  end_ = PlanEnd::kNothingSeen;
  if (stops_ >= config_.max_stops) return std::nullopt;
  const double range = config_.rot_to_deg - config_.rot_from_deg;
  const double away = static_cast<double>(stops_) * config_.search_step_deg;
  if (away >= std::min(range, kTurn_deg)) return std::nullopt;
  end_ = PlanEnd::kGoesOn;
  double rot = first_rot_deg_ + away;
  if (rot > config_.rot_to_deg) rot = config_.rot_from_deg + (rot - config_.rot_to_deg);
  return stop_angles(rot, nearest_to_zero(config_.swing_from_deg, config_.swing_to_deg));
}

double StopPlanner::worth(float cosine) const {
  const auto c = static_cast<double>(cosine);
  if (c < least_cosine_) return 0;
  const double well = std::min(1.0, (c - least_cosine_) / (good_cosine_ - least_cosine_));
  return 1 - config_.better_share + config_.better_share * well;
}

/// Known places that would be seen better, and image cells that show nothing known where the surface may go on: each
/// counts once, however many guesses lie in it.
StopPlanner::Gain StopPlanner::gain_of(const Candidate& candidate) {
  Gain out;
  forecast_.look_from(candidate.T_model_cam, surface_.cells());
  for (const ViewForecast::View& view : forecast_.seen()) {
    const SeenCell& cell = surface_.cells()[view.cell];
    const auto area = static_cast<double>(cell.area_mm2);
    out.overlap_mm2 += area;
    const double better = worth(view.cosine) - worth(cell.cosine);
    if (better > 0) out.gain_mm2 += std::ldexp(area * better, -static_cast<int>(cell.vain));
  }
  by_picture_.assign(forecast_.picture().size(), 0);
  for (std::size_t n = 0; n < surface_.expected().size(); ++n) {
    const ExpectedCell& e = surface_.expected()[n];
    std::size_t at = 0;
    if (e.weight < kAskedWeight) continue;
    const float cosine = forecast_.look_at(e.point, e.normal, at);
    if (cosine <= 0) continue;
    in_reach_[n] = 1;
    if (forecast_.picture().is_empty(at))
      by_picture_[at] = std::max(by_picture_[at], e.weight * forecast_.area_mm2(cosine));
  }
  for (const float area : by_picture_) out.gain_mm2 += static_cast<double>(area);
  return out;
}

double StopPlanner::usual_picture_mm2() const {
  std::vector<double> sorted = pictures_mm2_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

double StopPlanner::cost_s(const Candidate& c) const {
  const double way = std::max(std::abs(c.rot_deg - rot_deg_), std::abs(c.swing_deg - swing_deg_));
  return config_.stop_s + way / config_.speed_deg_per_s;
}

std::optional<calib::AxisAngles> StopPlanner::plan() {
  const double least_gain = config_.min_gain * usual_picture_mm2();
  const double least_overlap = config_.min_overlap * usual_picture_mm2();
  const Candidate* best = nullptr;
  double best_rate = 0;
  for (const Candidate& c : candidates_) {
    if (c.is_taken) continue;
    const Gain g = gain_of(c);
    if (g.overlap_mm2 < least_overlap || g.gain_mm2 < least_gain) continue;
    const double rate = g.gain_mm2 / cost_s(c);
    if (rate <= best_rate) continue;
    best_rate = rate;
    best = &c;
  }
  end_ = best == nullptr ? PlanEnd::kComplete : stops_ >= config_.max_stops ? PlanEnd::kMaxStops : PlanEnd::kGoesOn;
  if (end_ != PlanEnd::kGoesOn) return std::nullopt;
  return stop_angles(best->rot_deg, best->swing_deg);
}

PlanFigures StopPlanner::figures() const {
  PlanFigures out;
  out.stops = stops_;
  out.end = end_;
  if (pictures_mm2_.empty()) return out;
  out.seen_mm2 = surface_.area_mm2(least_cosine_);
  double beyond = 0;
  const double edge = surface_.expected_cell_mm();
  for (std::size_t n = 0; n < surface_.expected().size(); ++n) {
    const ExpectedCell& e = surface_.expected()[n];
    const auto crossed = static_cast<double>(std::max(1.0F, e.normal.lpNorm<1>()));
    if (in_reach_[n] != 0) beyond += static_cast<double>(e.weight) * edge * edge / crossed;
  }
  if (out.seen_mm2 > 0) out.share_seen = out.seen_mm2 / (out.seen_mm2 + beyond);
  return out;
}

}  // namespace enamel::pipeline
