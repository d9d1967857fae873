// Probes of other protocol versions are told, not waited for in vain: real DDS, one process.
#include <dds/dds.h>
#include <gmock/gmock.h>
#include <scanner.h>
#include <unistd.h>

#include "host/ingest/probe_link.hpp"

namespace enamel::host {
namespace {

using testing::HasSubstr;

class ProtocolVersion : public testing::Test {
 protected:
  ProtocolVersion() : participant(*dds::Participant::create({77, "version-" + std::to_string(getpid())})) {
    link = std::move(*ProbeLink::create(participant, {}, clock));
  }
  /// Calls `look` until it says yes, 10 s at most.
  template <class F>
  bool until(const F& look) {
    const HostTime end = clock.now() + std::chrono::seconds(10);
    while (clock.now() < end) {
      if (look()) return true;
      clock.sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  SteadyClock clock;
  dds::Participant participant;
  std::unique_ptr<ProbeLink> link;
};

TEST_F(ProtocolVersion, a_probe_of_ours_is_found) {
  auto infos = dds::Writer<proto::DeviceInfo>::create(participant);
  proto::DeviceInfo info;
  info.serial = "SAME";
  ASSERT_TRUE(infos->write(info).has_value());
  EXPECT_TRUE(until([&] {
    const auto found = link->find();
    EXPECT_TRUE(found.has_value());
    return found && found->has_value();
  }));
  EXPECT_EQ(link->not_found().code, ErrorCode::kProbeNotFound) << "no foreign version is seen";
}

TEST_F(ProtocolVersion, a_minor_that_differs_is_refused_by_name) {
  auto infos = dds::Writer<proto::DeviceInfo>::create(participant);
  proto::DeviceInfo info;
  info.serial = "OLDER";
  info.protocol_version = proto::kProtocolVersion + 1;
  ASSERT_TRUE(infos->write(info).has_value());
  Error error{};
  ASSERT_TRUE(until([&] {
    const auto found = link->find();
    if (!found) error = found.error();
    return !found;
  }));
  EXPECT_EQ(error.code, ErrorCode::kProbeVersion);
  EXPECT_THAT(error.detail, HasSubstr("OLDER speaks protocol 2, this program 1"));
  EXPECT_FALSE(link->probe().has_value());
}

TEST_F(ProtocolVersion, a_major_that_differs_is_seen_by_its_topics) {
  const dds_entity_t other = dds_create_participant(77, nullptr, nullptr);
  const dds_entity_t topic =
      dds_create_topic(other, &enamel_v1_DeviceInfo_desc, "enamel/v2/device_info", nullptr, nullptr);
  ASSERT_GT(dds_create_writer(other, topic, nullptr, nullptr), 0);
  EXPECT_TRUE(until([&] { return link->not_found().code == ErrorCode::kProbeVersion; }));
  EXPECT_THAT(link->not_found().detail, HasSubstr("programs of protocol 2; this one speaks 1"));
  dds_delete(other);
}

}  // namespace
}  // namespace enamel::host
