#include "calib/solve/variance.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "calib/solve/median.hpp"

namespace enamel::calib {
namespace {

constexpr int kBisections = 40;      // of [0, 1] px²: to a millionth of a millionth
constexpr double kMinFactor = 0.05;  // an instrument is never trusted beyond this against its own figures

}  // namespace

VarianceFactors estimate_variance(const std::vector<PoseView>& poses, const TargetDesign& target,
                                  const BundleOptions& options, const RigState& state) {
  const BundleResult now = evaluate(poses, target, options, state);
  std::vector<double> projector;
  for (const DotResidual& r : now.residuals) projector.push_back(r.projector_chi2);
  // Median of chi² with two degrees of freedom: 2 ln 2. The fit itself took a share of the freedom away.
  const double share = std::max(0.1, 1 - static_cast<double>(now.parameters) / std::max(1, now.observations));
  const double expected = 2 * std::numbers::ln2 * share;
  const auto camera_median = [&](double floor_px2) {
    std::vector<double> chi2;
    for (const DotResidual& r : now.residuals) {
      const Eigen::Matrix2d covariance =
          poses[r.pose].dots[r.view].covariance_px2 + floor_px2 * Eigen::Matrix2d::Identity();
      chi2.push_back(r.camera_px.dot(covariance.inverse() * r.camera_px));
    }
    return median(std::move(chi2));
  };
  VarianceFactors out;
  out.projector = std::max(kMinFactor, options.variance.projector * median(projector) / expected);
  const double stated = camera_median(0) / expected;
  if (stated <= 1) {
    out.camera = std::max(kMinFactor, stated);
    return out;
  }
  double low = 0, high = 1;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (camera_median(middle) > expected ? low : high) = middle;
  }
  out.camera_floor_px2 = 0.5 * (low + high);
  return out;
}

double ground_factor(std::vector<double> chi2) {
  constexpr double kMedianOfChi2 = 0.455;
  return std::max(1.0, median(std::move(chi2)) / kMedianOfChi2);
}

std::optional<WorstPose> worst_pose(const std::vector<PoseView>& poses, const BundleResult& residuals) {
  std::vector<std::vector<double>> dots(poses.size());
  std::vector<std::array<double, 2>> sum(poses.size(), {0, 0});
  for (const DotResidual& r : residuals.residuals) {
    dots[r.pose].push_back(r.camera_chi2 + r.projector_chi2);
    sum[r.pose][0] += r.camera_chi2;
    sum[r.pose][1] += r.projector_chi2;
  }
  std::vector<double> typical;
  typical.reserve(dots.size());
  for (const auto& d : dots) typical.push_back(median(d));
  if (typical.empty()) return {};
  const auto worst = static_cast<std::size_t>(std::max_element(typical.begin(), typical.end()) - typical.begin());
  const double middle = median(typical);
  if (!(middle > 0)) return {};
  return WorstPose{worst, typical[worst] / middle, sum[worst][1] > sum[worst][0]};
}

}  // namespace enamel::calib
