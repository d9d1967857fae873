// Our encoder and decoder against the bytes that Cyclone itself makes of the generated types.
#include <gtest/gtest.h>
#include <unistd.h>

#include "protocol/dds/endpoint.hpp"
#include "protocol/dds/wire.hpp"
#include "protocol/types/cdr.hpp"
#include "tests/unit/protocol/random_messages.hpp"

namespace enamel::dds {
namespace {

template <class T>
class CycloneBytes : public ::testing::Test {};
using Messages =
    ::testing::Types<proto::Burst, proto::DeviceInfo, proto::Status, proto::Command, proto::CommandReply, proto::Event,
                     proto::TimeSyncReq, proto::TimeSyncRep, proto::AxesReading, proto::ShedNote>;
TYPED_TEST_SUITE(CycloneBytes, Messages);

constexpr TopicQos kTestQos{"enamel/test/bytes", true, false, 0, 512, 1000, 0};

TYPED_TEST(CycloneBytes, equal_ours_both_ways) {
  const auto participant = Participant::create({.tag = "bytes-" + std::to_string(getpid())});
  ASSERT_TRUE(participant) << participant.error().message();
  auto reader = ReaderEnd::create(*participant, kTestQos, Wire<TypeParam>::descriptor());
  auto writer = WriterEnd::create(*participant, kTestQos, Wire<TypeParam>::descriptor());
  ASSERT_TRUE(reader && writer);
  test::Random random(5);
  for (int i = 0; i < 100; ++i) {
    TypeParam value;
    test::randomize(random, value);
    typename Wire<TypeParam>::Type wire{};
    ASSERT_TRUE(Wire<TypeParam>::fill(wire, value));
    ASSERT_TRUE((*writer)->write(&wire));
    ASSERT_EQ((*reader)->wait(std::chrono::seconds(20)), Wake::kData);
    const auto raw = (*reader)->take(16);
    ASSERT_TRUE(raw);
    ASSERT_EQ(raw->size(), 1U);
    EXPECT_EQ(raw->front().cdr, proto::to_cdr(value).value());
    const auto back = proto::from_cdr<TypeParam>(raw->front().cdr);
    ASSERT_TRUE(back) << back.error().message();
    EXPECT_EQ(*back, value);
  }
}

}  // namespace
}  // namespace enamel::dds
