// How well the residuals match their stated variances, for instruments and for poses. Private to calib/solve.
#pragma once

#include <optional>

#include "calib/solve/bundle.hpp"

namespace enamel::calib {

/// Factors that bring each instrument's chi² to its redundancy, by the median of the dots' chi² (deaf to a bad pose).
/// The camera gets a floor where its residuals are larger than stated, a factor where they are smaller.
[[nodiscard]] VarianceFactors estimate_variance(const std::vector<PoseView>& poses, const TargetDesign& target,
                                                const BundleOptions& options, const RigState& state);

/// Factor of the ground's variance by the median of its chi² (one degree of freedom): dust and shadow borders have no
/// say. At least 1: the scatter inside the blocks is what the pixels bring, what planes show beyond it does not
/// average.
[[nodiscard]] double ground_factor(std::vector<double> chi2);

struct WorstPose {
  std::size_t pose = 0;
  double ratio = 1;  ///< of its chi² to that of the median pose
  bool is_projector = false;
};

/// By the median over all its dots, outliers too: a pose that moved makes outliers of its own dots, and one wrong dot
/// is no reason against its pose.
[[nodiscard]] std::optional<WorstPose> worst_pose(const std::vector<PoseView>& poses, const BundleResult& residuals);

}  // namespace enamel::calib
