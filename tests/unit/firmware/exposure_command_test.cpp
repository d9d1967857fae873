// SET_EXPOSURE of the probe's control.
#include <gtest/gtest.h>

#include "tests/unit/firmware/control_fakes.hpp"

namespace enamel::fw::test {
namespace {

using proto::Opcode;
using proto::ReplyStatus;

class ExposureCommand : public testing::Test, public ControlRig {};

TEST_F(ExposureCommand, exposes_as_its_host_asks_until_another_session) {
  ready();
  EXPECT_EQ(send(Opcode::kSetExposure, 2, 900).status, ReplyStatus::kNotOwner);
  EXPECT_EQ(send(Opcode::kSetExposure, 1, 900).status, ReplyStatus::kOk);
  EXPECT_EQ(acquisition.exposure, 900U);
  const auto beyond = send(Opcode::kSetExposure, 1, 5000);
  EXPECT_EQ(beyond.status, ReplyStatus::kBadArg);
  EXPECT_EQ(beyond.detail, "must be up to 3800");
  EXPECT_EQ(send(Opcode::kSetExposure, 1, -1).status, ReplyStatus::kBadArg);
  EXPECT_EQ(send(Opcode::kSetExposure, 1, std::int64_t{1} << 40).status, ReplyStatus::kBadArg);
  EXPECT_EQ(acquisition.exposure, 900U) << "what is refused changes nothing";
  EXPECT_EQ(send(Opcode::kSessionClose).status, ReplyStatus::kOk);
  EXPECT_EQ(send(Opcode::kSessionOpen, 2).status, ReplyStatus::kOk);
  EXPECT_EQ(acquisition.exposure, 0U) << "the host before has left";
  acquisition.is_fixed = true;
  const auto fixed = send(Opcode::kSetExposure, 2, 900);
  EXPECT_EQ(fixed.status, ReplyStatus::kUnknownOp);
  EXPECT_EQ(fixed.detail, "bound to the pattern");
}

}  // namespace
}  // namespace enamel::fw::test
