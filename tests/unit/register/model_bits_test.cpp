// The same bursts give the same field and the same pose from every compiler and on every instruction set.
#include <gtest/gtest.h>

#include <iomanip>

#include "pipeline/types/simd.hpp"
// simd.hpp says for which sets the loops are compiled.
#include <hwy/highway.h>

#include "tests/unit/register/model_bits_scene.hpp"

namespace enamel::pipeline {
namespace {

constexpr double kSamePose_mm = 1e-4;  // what another library of linear algebra may add

void expect_bits() {
  const test::ModelBits found = test::model_bits();
  EXPECT_EQ(found.field, test::kFieldBits);
  EXPECT_EQ(found.view, test::kViewBits);
  ASSERT_TRUE(found.registered);
  const double apart = test::apart_mm(found.T_model_cam, test::registered_pose());
  EXPECT_LT(apart, kSamePose_mm) << std::setprecision(17) << found.T_model_cam.matrix();
}

TEST(ModelBits, are_those_of_every_instruction_set_of_this_machine) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    SCOPED_TRACE(hwy::TargetName(target));
    expect_bits();
  }
  hwy::SetSupportedTargetsForTest(0);
}

/// The control: a start that registration does not leave is not the pose.
TEST(ModelBits, pose_is_not_the_one_it_began_with) {
  const test::ModelBits found = test::model_bits();
  EXPECT_GT(test::apart_mm(found.T_model_cam, test::beside(test::registered_pose())), 100 * kSamePose_mm);
}

}  // namespace
}  // namespace enamel::pipeline
