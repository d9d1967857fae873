#include "calib/solve/refine_lens.hpp"

#include <ceres/ceres.h>

#include <cmath>

#include "calib/solve/projection.hpp"

namespace enamel::calib {
namespace {

constexpr double kHuber_px = 1.0;  // a start may hold a mistaken point

struct PointResidual {
  Eigen::Vector2d target, image_px;

  template <class T>
  bool operator()(const T* lens, const T* motion, T* residual) const {
    const auto p = move(motion, {T(target.x()), T(target.y()), T(0)});
    const auto q = image(lens, p);
    residual[0] = q[0] - image_px.x();
    residual[1] = q[1] - image_px.y();
    return true;
  }
};

double rms(const std::vector<PlaneView>& views, const LensBlock& lens, const std::vector<MotionBlock>& motions) {
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t j = 0; j < views.size(); ++j) {
    for (std::size_t i = 0; i < views[j].target_mm.size(); ++i) {
      double r[2];
      PointResidual{views[j].target_mm[i], views[j].image_px[i]}(lens.data(), motions[j].data(), r);
      sum += r[0] * r[0] + r[1] * r[1];
      ++n;
    }
  }
  return std::sqrt(sum / static_cast<double>(n));
}

}  // namespace

void refine_stepwise(const std::vector<PlaneView>& views, LensStart& start) {
  LensBlock lens = block_of(start.lens);
  std::vector<MotionBlock> motions;
  for (const Pose& p : start.T_lens_target) motions.push_back(block_of(p));
  // What stays fixed at each step; k3 (8) always: the field is too narrow to tell it from k2.
  const std::vector<std::vector<int>> steps{{2, 3, 4, 5, 6, 7, 8}, {2, 3, 5, 6, 7, 8}, {2, 3, 6, 7, 8}, {2, 3, 8}, {8}};
  for (const auto& fixed : steps) {
    ceres::Problem problem;
    for (std::size_t j = 0; j < views.size(); ++j) {
      for (std::size_t i = 0; i < views[j].target_mm.size(); ++i) {
        problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PointResidual, 2, 9, 6>(
                                     new PointResidual{views[j].target_mm[i], views[j].image_px[i]}),
                                 new ceres::HuberLoss(kHuber_px), lens.data(), motions[j].data());
      }
    }
    problem.SetManifold(lens.data(), new ceres::SubsetManifold(9, fixed));
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.max_num_iterations = 30;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
  }
  set_lens(start.lens, lens);
  for (std::size_t j = 0; j < motions.size(); ++j) start.T_lens_target[j] = pose_of(motions[j]);
  start.rms_px = rms(views, lens, motions);
}

}  // namespace enamel::calib
