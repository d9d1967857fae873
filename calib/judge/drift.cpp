#include "calib/judge/drift.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace enamel::calib {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Limits: a depth or tilt of 10 um bends space by 2e-4, as much as a calibration's scale may be off; bends are those
/// that a calibration is refused at.
/// Heights that one unit of theta makes at 48 mm, um: dz = z² delta, x = X/z. `prior_um` says what cannot be: it holds
/// only what the scan leaves free.
struct Mode {
  const char* name;
  double um_per_unit, limit_um, prior_um;
};

constexpr double kZ = kDriftPivot_mm, kHalf_mm = 8;
constexpr std::array<Mode, kDriftModes> kModes{{{"depth", 1e3 * kZ* kZ, 10, 1000},
                                                {"tilt_x", 1e3 * kZ* kHalf_mm, 10, 300},
                                                {"tilt_y", 1e3 * kZ* kHalf_mm, 10, 300},
                                                {"twist", 1e3 * kHalf_mm* kHalf_mm, 0.5, 100},
                                                {"sag_x", 1e3 * kHalf_mm* kHalf_mm, 0.5, 100},
                                                {"sag_y", 1e3 * kHalf_mm* kHalf_mm, 0.5, 100}}};
// Damps what nothing holds, a step at a time. Any firmer and the motion that all views share would creep.
constexpr double kPoseStep_mm = 10, kPoseStep_rad = 0.2;

struct Pair {
  std::size_t from, onto;
  PairSystem system;
};

void move(DriftView& view, const Eigen::Ref<const VectorXd>& x) {
  const Vec3d omega = x.head<3>(), pivot(0, 0, kDriftPivot_mm);
  Pose step = Pose::Identity();
  if (omega.norm() > 0) step.linear() = Eigen::AngleAxisd(omega.norm(), omega.normalized()).toRotationMatrix();
  step.translation() = pivot + Vec3d(x.segment<3>(3)) - step.linear() * pivot;
  view.T_model_cam = view.T_model_cam * step;
}

std::vector<Pair> overlaps(const std::vector<DriftView>& views, const LensValues& camera, const DriftVector& theta,
                           const DriftConfig& config) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (std::size_t j = i + 1; j < views.size(); ++j) {
      const bool is_forward = (i + j) % 2 == 0;  // either way alike: neither surface's noise is favoured
      const std::size_t from = is_forward ? i : j, onto = is_forward ? j : i;
      PairSystem system = overlap(views[from], views[onto], camera, theta, config.overlap);
      if (system.matches >= config.min_matches) pairs.push_back({from, onto, std::move(system)});
    }
  }
  return pairs;
}

/// Views that take no part are held by their priors.
struct Adjustment {
  MatrixXd H;
  VectorXd g;

  explicit Adjustment(std::size_t views) {
    const Index n = 6 * static_cast<Index>(views) + kDriftModes;
    H = MatrixXd::Zero(n, n);
    g = VectorXd::Zero(n);
    for (std::size_t i = 0; i < views; ++i) {
      const double firm = i == 0 ? 1e8 : 1;  // the first view holds the frame
      for (Index k = 0; k < 3; ++k) {
        H(6 * static_cast<Index>(i) + k, 6 * static_cast<Index>(i) + k) = firm / (kPoseStep_rad * kPoseStep_rad);
        H(6 * static_cast<Index>(i) + 3 + k, 6 * static_cast<Index>(i) + 3 + k) = firm / (kPoseStep_mm * kPoseStep_mm);
      }
    }
  }

  void add(const Pair& pair) {
    const Index at[3] = {6 * static_cast<Index>(pair.from), 6 * static_cast<Index>(pair.onto), H.rows() - kDriftModes};
    const Index size[3] = {6, 6, kDriftModes};
    Index row = 0;
    for (int a = 0; a < 3; ++a) {
      g.segment(at[a], size[a]) += pair.system.g.segment(row, size[a]);
      Index column = 0;
      for (int b = 0; b < 3; ++b) {
        H.block(at[a], at[b], size[a], size[b]) += pair.system.H.block(row, column, size[a], size[b]);
        column += size[b];
      }
      row += size[a];
    }
  }

  /// Step of poses and theta; theta stays 0 where it takes no part.
  [[nodiscard]] VectorXd solve(const DriftVector& theta, bool with_drift) const {
    const Index poses = H.rows() - kDriftModes;
    if (!with_drift) {
      VectorXd x = VectorXd::Zero(H.rows());
      x.head(poses) = H.topLeftCorner(poses, poses).ldlt().solve(-g.head(poses));
      return x;
    }
    MatrixXd h = H;
    VectorXd b = -g;
    for (Index m = 0; m < kDriftModes; ++m) {
      const Mode& mode = kModes[static_cast<std::size_t>(m)];
      const double weight = std::pow(mode.um_per_unit / mode.prior_um, 2);
      h(poses + m, poses + m) += weight;
      b[poses + m] -= weight * theta[m];
    }
    return h.ldlt().solve(b);
  }
};

double rms_um(const std::vector<Pair>& pairs) {
  double squares = 0, weight = 0;
  for (const Pair& p : pairs) {
    squares += p.system.weighted_squares;
    weight += p.system.weight;
  }
  return weight > 0 ? 1e3 * std::sqrt(squares / weight) : 0;
}

/// Poses (and theta) to rest; the pairs at the end.
std::vector<Pair> adjust(std::vector<DriftView>& views, const LensValues& camera, DriftVector& theta, bool with_drift,
                         const DriftConfig& config) {
  const int passes = with_drift ? config.iterations : 1;
  for (int pass = 0; pass < passes; ++pass) {
    Adjustment sum(views.size());
    for (const Pair& pair : overlaps(views, camera, theta, config)) sum.add(pair);
    const VectorXd step = sum.solve(theta, with_drift);
    for (std::size_t i = 0; i < views.size(); ++i) move(views[i], step.segment(6 * static_cast<Index>(i), 6));
    theta += step.tail<kDriftModes>();
  }
  return overlaps(views, camera, theta, config);
}

/// Variance of theta by leaving out one stretch of views at a time: the views are the independent units, not the pairs.
DriftVector jackknife(const std::vector<Pair>& pairs, std::size_t views, const DriftVector& theta, int stretches) {
  std::vector<DriftVector> steps;
  DriftVector mean = DriftVector::Zero();
  for (int k = 0; k < stretches; ++k) {
    const auto is_out = [&](std::size_t view) {
      return static_cast<int>(view * static_cast<std::size_t>(stretches) / views) == k;
    };
    Adjustment sum(views);
    for (const Pair& pair : pairs)
      if (!is_out(pair.from) && !is_out(pair.onto)) sum.add(pair);
    steps.emplace_back(sum.solve(theta, true).tail<kDriftModes>());
    mean += steps.back() / stretches;
  }
  DriftVector variance = DriftVector::Zero();
  for (const DriftVector& s : steps) variance += (s - mean).cwiseAbs2() * (stretches - 1.0) / stretches;
  return variance;
}

}  // namespace

bool DriftCheck::is_alarm() const {
  return std::any_of(figures.begin(), figures.end(), [](const DriftFigure& f) { return f.is_alarm; });
}

std::vector<std::string> DriftCheck::blind() const {
  std::vector<std::string> names;
  for (const DriftFigure& f : figures)
    if (f.smallest_um > 10 * f.limit_um) names.emplace_back(f.name);
  return names;
}

Result<DriftCheck> check_drift(std::vector<DriftView> views, const LensValues& camera, const DriftConfig& config) {
  if (views.size() < 2 * static_cast<std::size_t>(config.stretches)) {
    return fail(ErrorCode::kCalibrationPoses, fmt::format("{} bursts were placed, the self-check wants {}; scan longer",
                                                          views.size(), 2 * config.stretches));
  }
  DriftCheck out;
  out.views = views.size();
  adjust(views, camera, out.theta, false, config);
  DriftConfig fine = config;
  fine.overlap.max_distance_mm = config.fine_distance_mm;
  out.rms_before_um = rms_um(adjust(views, camera, out.theta, false, fine));
  const std::vector<Pair> pairs = adjust(views, camera, out.theta, true, fine);
  out.rms_after_um = rms_um(pairs);
  out.pairs = pairs.size();
  for (const Pair& p : pairs) out.matches += p.system.matches;
  if (pairs.size() < 2 * views.size()) {
    return fail(ErrorCode::kCalibrationPoses,
                fmt::format("only {} pairs of {} bursts overlap; scan the same place from two sides", pairs.size(),
                            views.size()));
  }
  const DriftVector variance = jackknife(pairs, views.size(), out.theta, config.stretches);
  for (std::size_t m = 0; m < kModes.size(); ++m) {
    const auto at = static_cast<Index>(m);
    DriftFigure& f = out.figures[m];
    f.name = kModes[m].name;
    f.um = out.theta[at] * kModes[m].um_per_unit;
    f.sigma_um = std::sqrt(variance[at]) * kModes[m].um_per_unit;
    f.limit_um = kModes[m].limit_um;
    f.smallest_um = std::max(f.limit_um, config.sigmas * f.sigma_um);  // it must matter, and be no chance
    f.is_alarm = std::abs(f.um) > f.smallest_um;
  }
  return out;
}

}  // namespace enamel::calib
