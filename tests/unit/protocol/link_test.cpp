// Link profiles: what they say, and where they find the network.
#include "protocol/dds/link.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "protocol/dds/participant.hpp"

namespace enamel::dds {
namespace {

using testing::HasSubstr;

std::string file_of(const std::string& text) {
  const auto path = std::filesystem::path(testing::TempDir()) / "link.toml";
  std::ofstream(path) << text;
  return path.string();
}

TEST(Link, datagrams_over_a_cable_fit_its_frames) {
  for (const char* name : {"usb", "wifi"}) {
    const auto profile = read_link(name);
    ASSERT_TRUE(profile.has_value());
    constexpr int kMtu = 1500, kIpAndUdp = 28;
    EXPECT_LE(profile->message_bytes + kIpAndUdp, kMtu) << name;
    EXPECT_LT(profile->fragment_bytes + 100, profile->message_bytes) << name;
  }
}

TEST(Link, a_file_starts_from_a_profile) {
  const auto profile =
      read_link(file_of("[link]\nbase = \"wifi\"\ninterface = \"wlan0\"\npeers = [\"10.0.0.7\"]\n"
                        "heartbeat_ms = 50\n"));
  ASSERT_TRUE(profile.has_value()) << profile.error().message();
  EXPECT_EQ(profile->interface, "wlan0");
  EXPECT_EQ(profile->heartbeat_ms, 50);
  EXPECT_EQ(profile->message_bytes, read_link("wifi")->message_bytes);
  const std::string xml = cyclone_config({.link = *profile}, "wlan0");
  EXPECT_THAT(xml, HasSubstr("<NetworkInterface name=\"wlan0\" multicast=\"false\"/>"));
  EXPECT_THAT(xml, HasSubstr("<Peer Address=\"10.0.0.7\"/>"));
  EXPECT_THAT(xml, HasSubstr(">50ms</HeartbeatInterval>"));
}

TEST(Link, what_cannot_work_is_refused_by_name) {
  EXPECT_EQ(read_link("ethernet").error().code, ErrorCode::kUsage);
  EXPECT_EQ(read_link("/nowhere/link.toml").error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(read_link(file_of("[link]\nmtu = 9000\n")).error().code, ErrorCode::kConfigUnknownKey);
  EXPECT_THAT(read_link(file_of("[link]\nmessage_bytes = 1400\n")).error().detail, HasSubstr("must fit"));
  EXPECT_THAT(read_link(file_of("[link]\nbase = \"tin\"\n")).error().detail, HasSubstr("loopback, usb or wifi"));
}

TEST(Link, interface_is_found_by_name_network_and_other_end) {
  LinkProfile profile;
  EXPECT_EQ(interface_of(profile).value_or(""), "lo");
  profile.interface = "127.0.0.0/8";
  EXPECT_EQ(interface_of(profile).value_or(""), "lo");
  profile.interface = "auto";
  profile.peers = {"127.0.0.9"};
  EXPECT_EQ(interface_of(profile).value_or(""), "lo");
  for (const char* wrong : {"nosuch0", "203.0.113.0/24", "127.0.0.0/33", "127.0.0/8", "127.0.0.0/x"}) {
    profile.interface = wrong;
    const auto none = interface_of(profile);
    ASSERT_FALSE(none.has_value()) << wrong;
    EXPECT_EQ(none.error().code, ErrorCode::kDds);
    EXPECT_THAT(none.error().detail, HasSubstr("lo 127.0.0.1"));
  }
}

TEST(Link, without_multicast_the_host_must_know_the_probe) {
  EXPECT_EQ(participant_options({.link = "wifi"}, LinkEnd::kHost).error().code, ErrorCode::kUsage);
  EXPECT_TRUE(participant_options({.link = "wifi"}, LinkEnd::kProbe).has_value());
  const auto told = participant_options({.link = "wifi", .peers = {"10.0.0.7"}}, LinkEnd::kHost);
  ASSERT_TRUE(told.has_value());
  EXPECT_THAT(told->link->peers, testing::ElementsAre("10.0.0.7"));
  EXPECT_EQ(participant_options({.peers = {"10.0.0.7"}}, LinkEnd::kHost).error().code, ErrorCode::kUsage);
  EXPECT_FALSE(participant_options({}, LinkEnd::kHost)->link.has_value()) << "CYCLONEDDS_URI may rule";
}

}  // namespace
}  // namespace enamel::dds
