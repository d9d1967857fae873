#include "calib/solve/solve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calib/solve/disc_centres.hpp"
#include "calib/solve/ground.hpp"
#include "calib/solve/lens_start.hpp"
#include "calib/solve/sanity.hpp"
#include "calib/solve/variance.hpp"

namespace enamel::calib {
namespace {

constexpr double kOutlierChi2 = 40;  // four degrees of freedom: one good dot in 20 million
constexpr double kBadPoseRatio = 4;  // of a pose's chi² per observation to the median pose's
constexpr int kMaxBiasRounds = 6;
constexpr double kBiasSettled_px = 2e-5;

enum class Instrument { kCamera, kProjector };

std::vector<PlaneView> plane_views(const std::vector<PoseView>& poses, const TargetDesign& target, Instrument which) {
  std::vector<PlaneView> views;
  for (const PoseView& pose : poses) {
    PlaneView view{.name = pose.name, .target_mm = {}, .image_px = {}};
    for (const DotView& dot : pose.dots) {
      view.target_mm.emplace_back(target.place(dot.dot).head<2>());
      view.image_px.push_back(which == Instrument::kCamera ? dot.camera_px : dot.map.projector_px);
    }
    views.push_back(std::move(view));
  }
  return views;
}

/// Relative pose from pairs of poses: mean rotation (as a quaternion sum) and mean translation.
Pose mean_relative(const std::vector<Pose>& T_cam_target, const std::vector<Pose>& T_proj_target) {
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  Vec3d shift = Vec3d::Zero();
  for (std::size_t j = 0; j < T_cam_target.size(); ++j) {
    const Pose relative = T_proj_target[j] * T_cam_target[j].inverse();
    Eigen::Vector4d q = Eigen::Quaterniond(relative.linear()).coeffs();
    if (q.dot(sum) < 0) q = -q;
    sum += q;
    shift += relative.translation() / static_cast<double>(T_cam_target.size());
  }
  Pose mean = Pose::Identity();
  mean.linear() = Eigen::Quaterniond(sum.normalized()).toRotationMatrix();
  mean.translation() = shift;
  return mean;
}

bool is_copy(const PoseView& a, const PoseView& b) {
  return std::equal(a.dots.begin(), a.dots.end(), b.dots.begin(), b.dots.end(), [](const DotView& p, const DotView& q) {
    return p.dot == q.dot && p.ellipse.centre == q.ellipse.centre;
  });
}

class Solver {
 public:
  Solver(std::vector<PoseView> views, const TargetDesign& target, const Rig& nominal, const SolveOptions& options)
      : target_(target), nominal_(nominal), options_(options) {
    s_.poses = std::move(views);
    s_.options.shape = options.shape_prior;
  }

  Result<Solution> run() {
    drop_copies();
    ENAMEL_TRY(check_views(s_.poses, target_, nominal_));
    remove_ripple();
    ENAMEL_TRY(start());
    ENAMEL_TRY(check_tilts(s_.state.T_cam_target));
    ENAMEL_TRY(check_baseline(s_.state.T_proj_cam, target_, nominal_));
    const RigState start_state = s_.state;
    step("bundle");
    settle();
    ENAMEL_TRY(reject_bad_poses());
    choose_shape();
    s_.steps = {{"start", start_state}, {"bundle", s_.state}};
    choose_planes();
    s_.options.with_covariance = true;
    s_.result = bundle(s_.poses, target_, s_.options, s_.state);
    if (s_.options.with_planes) s_.steps.push_back({"global", s_.state});
    correct();
    if (s_.result.covariance.size() == 0)
      return fail(ErrorCode::kCalibrationPoses, "the poses leave some of the rig's parameters open");
    count_outliers();
    return std::move(s_);
  }

 private:
  void step(const std::string& what) const {
    if (options_.on_step) options_.on_step(what);
  }

  /// The same pictures twice are no second observation: their noise would pass for the target's shape.
  void drop_copies() {
    std::vector<PoseView> kept;
    for (PoseView& pose : s_.poses) {
      const auto same = std::find_if(kept.begin(), kept.end(), [&](const PoseView& k) { return is_copy(k, pose); });
      if (same == kept.end()) {
        kept.push_back(std::move(pose));
      } else {
        s_.rejected.push_back({pose.name, "the same pictures as pose " + same->name});
      }
    }
    s_.poses = std::move(kept);
  }

  void remove_ripple() {
    std::vector<std::vector<ProjectorSample>> discs;
    for (const PoseView& pose : s_.poses)
      for (const DotView& dot : pose.dots) discs.push_back(dot.samples);
    const Ripple ripple = estimate_ripple(discs, options_.fringe_period_px);
    for (PoseView& pose : s_.poses) {
      for (DotView& dot : pose.dots) {
        ripple.remove(dot.samples);
        if (const auto map = fit_local_map(dot.samples, dot.camera_px)) dot.map = *map;
      }
      calib::remove_ripple(ripple, pose.ground);
    }
  }

  Result<void> start() {
    step("start");
    ENAMEL_TRY_ASSIGN(const LensStart camera,
                      best_start(plane_views(s_.poses, target_, Instrument::kCamera), nominal_.camera));
    ENAMEL_TRY_ASSIGN(const LensStart projector,
                      best_start(plane_views(s_.poses, target_, Instrument::kProjector), nominal_.projector));
    s_.start_method = fmt::format("camera by {} ({:.3f} px), projector by {} ({:.3f} px)", camera.method, camera.rms_px,
                                  projector.method, projector.rms_px);
    s_.notes.push_back("start: " + s_.start_method);
    for (const std::string& pose : camera.singular_poses)
      s_.notes.push_back("pose " + pose + " faces the camera: it says nothing about the focal length");
    s_.state.camera = camera.lens;
    s_.state.projector = projector.lens;
    s_.state.T_cam_target = camera.T_lens_target;
    s_.state.T_proj_cam = mean_relative(camera.T_lens_target, projector.T_lens_target);
    s_.state.dot_offsets_mm.assign(static_cast<std::size_t>(target_.size()), Vec3d::Zero());
    return {};
  }

  /// Bundle, unbiased centres, variance factors and outliers in turn until the centres rest.
  void settle() {
    for (int round = 0; round < kMaxBiasRounds; ++round) {
      s_.result = bundle(s_.poses, target_, s_.options, s_.state);
      const double moved = refine_centres(s_.poses, target_, s_.state);
      s_.options.variance = estimate_variance(s_.poses, target_, s_.options, s_.state);
      mark_outliers();
      if (moved < kBiasSettled_px && round > 1) break;
    }
    s_.result = bundle(s_.poses, target_, s_.options, s_.state);
  }

  void mark_outliers() {
    const BundleResult now = evaluate(s_.poses, target_, s_.options, s_.state);
    for (const DotResidual& r : now.residuals)
      s_.poses[r.pose].dots[r.view].is_outlier = r.camera_chi2 + r.projector_chi2 > kOutlierChi2;
  }

  void count_outliers() {
    for (const PoseView& pose : s_.poses) {
      const auto n = std::count_if(pose.dots.begin(), pose.dots.end(), [](const DotView& d) { return d.is_outlier; });
      if (n > 0) s_.notes.push_back(fmt::format("pose {}: {} dots left out as outliers", pose.name, n));
    }
  }

  /// One pose at a time, the worst first, so that its pull on the others does not condemn them.
  Result<void> reject_bad_poses() {
    for (;;) {
      const auto worst = worst_pose(s_.poses, evaluate(s_.poses, target_, s_.options, s_.state));
      if (!worst || worst->ratio < kBadPoseRatio) return {};
      s_.rejected.push_back(
          {s_.poses[worst->pose].name,
           fmt::format("its dots fit {:.1f} times worse than those of the median pose (largest share: {}); moved "
                       "between images, or not this target: take it again",
                       std::sqrt(worst->ratio), worst->is_projector ? "fringes against white" : "dots in white")});
      const auto at = static_cast<std::ptrdiff_t>(worst->pose);
      s_.poses.erase(s_.poses.begin() + at);
      s_.state.T_cam_target.erase(s_.state.T_cam_target.begin() + at);
      if (s_.poses.size() < kMinPoses) {
        return fail(ErrorCode::kCalibrationPoses,
                    fmt::format("{} usable poses are left; last rejected: {}, {}", s_.poses.size(),
                                s_.rejected.back().pose, s_.rejected.back().reason));
      }
      for (PoseView& pose : s_.poses)
        for (DotView& dot : pose.dots) dot.is_outlier = false;
      settle();
    }
  }

  /// The target's shape is solved when that explains more than its own freedom does by chance: an F test of the fall of
  /// chi², at five sigma of the F distribution's normal approximation.
  void choose_shape() {
    if (options_.shape == ShapeChoice::kPerfect) return;
    step("shape of the target");
    const Solution perfect = s_;
    s_.options.solve_shape = true;
    settle();
    s_.is_shape_solved = true;
    if (options_.shape == ShapeChoice::kSolve) return;
    const BundleResult with = evaluate(s_.poses, target_, s_.options, s_.state);
    BundleOptions same_scale = s_.options;
    same_scale.solve_shape = false;
    const BundleResult without = evaluate(perfect.poses, target_, same_scale, perfect.state);
    const double freedom = with.parameters - without.parameters;
    const double left = with.observations - with.parameters;
    if (left > 0) {
      const double f = ((without.chi2 - with.chi2) / freedom) / (with.chi2 / left);
      if (f > 1 + 5 * std::sqrt(2 / freedom + 2 / left) && !is_lens_to_blame(perfect)) {
        s_.notes.emplace_back("the target's dots are off their design: its shape was solved too");
        return;
      }
    }
    s_ = perfect;
  }

  /// What the lens model leaves moves dots as a bent target would. The ground, which had no part in either, tells one
  /// from the other: a target's shape travels with the target, a lens's error stays with the camera. True when a
  /// correction field, fitted without the plane it is judged by, makes the planes flatter than the solved shape does,
  /// by more than a standard error.
  bool is_lens_to_blame(const Solution& perfect) {
    const FieldChoice lens = choose_field(perfect.poses, target_, perfect.state);
    if (!lens.field) return false;
    const auto plain = plane_misfits(perfect.poses, target_, perfect.state);
    const auto shaped = plane_misfits(s_.poses, target_, s_.state);
    const auto& gains = lens.trials[lens.taken].gains;
    if (plain.size() != gains.size() || shaped.size() != gains.size()) return false;
    const double n = static_cast<double>(gains.size());
    double mean = 0, squares = 0;
    for (std::size_t j = 0; j < gains.size(); ++j) {
      const double more = gains[j] - (plain[j] - shaped[j]);
      mean += more / n;
      squares += more * more / n;
    }
    return mean > std::sqrt(std::max(0.0, squares - mean * mean) / (n - 1));
  }

  /// Step 3 takes the ground for a plane. A board whose shape is solved too is known by its dots alone, from the same
  /// pictures: its ground has nothing to add to them.
  void choose_planes() {
    const bool has_ground =
        std::any_of(s_.poses.begin(), s_.poses.end(), [](const auto& p) { return !p.ground.empty(); });
    if (!has_ground || s_.is_shape_solved) return;
    step("planes");
    s_.options.with_planes = true;
    s_.options.variance.ground = ground_factor(plane_chi2(s_.poses, target_, s_.state, 1));
  }

  void correct() {
    step("correction field");
    s_.field = choose_field(s_.poses, target_, s_.state);
    s_.state.correction = s_.field.field;
    if (s_.state.correction) s_.steps.push_back({"field", s_.state});
  }

  const TargetDesign& target_;
  const Rig& nominal_;
  const SolveOptions& options_;
  Solution s_;
};

}  // namespace

Result<Solution> solve(std::vector<PoseView> views, const TargetDesign& target, const Rig& nominal,
                       const SolveOptions& options) {
  return Solver(std::move(views), target, nominal, options).run();
}

}  // namespace enamel::calib
