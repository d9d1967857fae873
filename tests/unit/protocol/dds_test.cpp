#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <thread>

#include "protocol/dds/qos.hpp"
#include "protocol/dds/topics.hpp"
#include "tests/unit/protocol/random_messages.hpp"

namespace enamel::dds {
namespace {

using namespace std::chrono_literals;

std::string fresh_tag() {
  static int count = 0;
  return "test-" + std::to_string(getpid()) + "-" + std::to_string(count++);
}

// The helper program as a child; killed at the end if it still runs.
class Peer {
 public:
  explicit Peer(std::vector<std::string> args) {
    args.insert(args.begin(), ENAMEL_BIN_DIR "/dds_peer");
    std::vector<char*> raw;
    raw.reserve(args.size() + 1);
    for (std::string& arg : args) raw.push_back(arg.data());
    raw.push_back(nullptr);
    pid_ = fork();
    if (pid_ == 0) {
      execv(raw[0], raw.data());
      _exit(127);
    }
  }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  ~Peer() {
    if (pid_ > 0) kill_now();
  }
  void kill_now() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }
  int exit_code() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t pid_ = -1;
};

template <class Condition>
bool eventually(Condition&& condition) {
  for (int i = 0; i < 4000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(5ms);
  }
  return false;
}

// The next sample, passing over wakes that only tell of a peer that left.
template <class T>
T next_sample(Reader<T>& reader) {
  for (int i = 0; i < 100; ++i) {
    if (reader.wait(20s) != Wake::kData) break;
    auto taken = reader.take(1).value();
    if (!taken.empty()) return taken[0].value;
  }
  ADD_FAILURE() << "no sample";
  return {};
}

// Takes `count` bursts that must be exactly those that the peer sends, in order.
void expect_bursts(Reader<proto::Burst>& reader, std::uint64_t count, int width, int height) {
  std::uint64_t next = 0;
  while (next < count) {
    ASSERT_EQ(reader.wait(20s), Wake::kData) << "after " << next;
    const auto taken = reader.take(4);
    ASSERT_TRUE(taken) << taken.error().message();
    for (const auto& received : *taken) {
      ASSERT_TRUE(received.valid);
      proto::Burst expected = test::camera_burst(next % 8, width, height);
      expected.burst_seq = next;
      ASSERT_EQ(received.value, expected) << next;
      ASSERT_EQ(received.cdr, proto::to_cdr(expected).value());
      ++next;
    }
  }
}

TEST(Dds, sixty_vga_bursts_arrive_whole_from_another_process) {
  const std::string tag = fresh_tag();
  const auto participant = Participant::create({.tag = tag});
  ASSERT_TRUE(participant) << participant.error().message();
  auto reader = Reader<proto::Burst>::create(*participant);
  ASSERT_TRUE(reader) << reader.error().message();
  Peer peer({"send", tag, "60", "640", "480", "20000"});
  expect_bursts(*reader, 60, 640, 480);
  EXPECT_EQ(peer.exit_code(), 0);
}

// 200 bursts are more than reader and writer hold together: the writer has to wait, and nothing may vanish.
TEST(Dds, a_late_reader_holds_the_writer_back_and_loses_nothing) {
  const std::string tag = fresh_tag();
  const auto participant = Participant::create({.tag = tag});
  auto reader = Reader<proto::Burst>::create(*participant);
  ASSERT_TRUE(reader);
  Peer peer({"send", tag, "200", "320", "240", "0"});
  ASSERT_EQ(reader->wait(20s), Wake::kData);
  std::this_thread::sleep_for(1500ms);
  expect_bursts(*reader, 200, 320, 240);
  EXPECT_EQ(peer.exit_code(), 0);
}

TEST(Dds, a_killed_peer_is_noticed_and_its_return_too) {
  const std::string tag = fresh_tag();
  const auto participant = Participant::create({.tag = tag});
  auto statuses = Reader<proto::Status>::create(*participant);
  auto commands = Writer<proto::Command>::create(*participant);
  ASSERT_TRUE(statuses && commands);
  for (int round = 0; round < 2; ++round) {
    Peer peer({"idle", tag, std::to_string(round)});
    ASSERT_TRUE(eventually([&] { return statuses->peers().alive == 1 && commands->peers().matched == 1; }));
    EXPECT_EQ(next_sample(*statuses).seq, static_cast<std::uint32_t>(round));
    peer.kill_now();
    EXPECT_TRUE(eventually([&] { return statuses->peers().alive == 0 && commands->peers().matched == 0; }));
  }
  EXPECT_EQ(statuses->peers().ever_matched, 2U);
}

TEST(Dds, only_the_same_tag_is_seen) {
  const std::string tag = fresh_tag();
  const auto participant = Participant::create({.tag = tag});
  auto statuses = Reader<proto::Status>::create(*participant);
  ASSERT_TRUE(statuses);
  Peer stranger({"idle", fresh_tag(), "1"});
  Peer own({"idle", tag, "2"});
  ASSERT_TRUE(eventually([&] { return statuses->peers().matched > 0; }));
  std::this_thread::sleep_for(800ms);  // more than a discovery period
  EXPECT_EQ(statuses->peers().matched, 1);
  const auto taken = statuses->take().value();
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].value.seq, 2U);
}

TEST(Dds, a_domain_has_one_tag_in_a_process) {
  const auto first = Participant::create({.tag = fresh_tag()});
  ASSERT_TRUE(first);
  const auto second = Participant::create({.tag = fresh_tag()});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kDds);
}

class DdsInProcess : public ::testing::Test {
 protected:
  ParticipantOptions options_{.tag = fresh_tag()};
  Participant left_ = Participant::create(options_).value();
  Participant right_ = Participant::create(options_).value();
};

template <class T>
T exchanged(const Participant& from, const Participant& to, const T& value) {
  auto writer = Writer<T>::create(from).value();
  auto reader = Reader<T>::create(to).value();
  EXPECT_TRUE(eventually([&] { return writer.peers().matched == 1 && reader.peers().matched == 1; }));
  EXPECT_TRUE(writer.write(value));
  EXPECT_EQ(reader.wait(20s), Wake::kData);
  const auto taken = reader.take().value();
  EXPECT_EQ(taken.size(), 1U);
  return taken.empty() ? T{} : taken[0].value;
}

TEST_F(DdsInProcess, every_topic_carries_its_type) {
  test::Random random(9);
  const auto check = [&](auto value) {
    test::randomize(random, value);
    EXPECT_EQ(exchanged(left_, right_, value), value);
  };
  check(proto::Burst{});
  check(proto::DeviceInfo{});
  check(proto::Status{});
  check(proto::Command{});
  check(proto::CommandReply{});
  check(proto::Event{});
  check(proto::TimeSyncReq{});
  check(proto::TimeSyncRep{});
  check(proto::AxesReading{});
}

TEST_F(DdsInProcess, a_later_reader_gets_the_last_status_but_no_old_command) {
  auto statuses = Writer<proto::Status>::create(left_).value();
  auto commands = Writer<proto::Command>::create(left_).value();
  ASSERT_TRUE(statuses.write({.seq = 1}));
  ASSERT_TRUE(statuses.write({.seq = 2}));
  ASSERT_TRUE(commands.write({.cmd_id = 7}));
  auto status_reader = Reader<proto::Status>::create(right_).value();
  auto command_reader = Reader<proto::Command>::create(right_).value();
  ASSERT_EQ(status_reader.wait(20s), Wake::kData);
  const auto taken = status_reader.take().value();
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].value.seq, 2U);
  EXPECT_EQ(command_reader.wait(200ms), Wake::kTimeout);
}

// Negative control: events, of which as many are written, are kept to the depth of their history.
TEST_F(DdsInProcess, a_later_reader_gets_every_angle_in_order) {
  constexpr std::uint32_t kWritten = 300;
  auto axes = Writer<proto::AxesReading>::create(left_).value();
  auto events = Writer<proto::Event>::create(left_).value();
  for (std::uint32_t n = 0; n < kWritten; ++n) {
    ASSERT_TRUE(axes.write({.burst_index = n, .rot_cmd_deg = 0.5 * n, .probe_id = 5, .stop = n / 3}));
    ASSERT_TRUE(events.write({.probe_id = 5, .seq = n}));
  }
  auto late_axes = Reader<proto::AxesReading>::create(right_).value();
  auto late_events = Reader<proto::Event>::create(right_).value();
  std::vector<proto::AxesReading> got;
  while (got.size() < kWritten && late_axes.wait(20s) == Wake::kData) {
    const auto taken = late_axes.take(64).value();
    for (const auto& received : taken) got.push_back(received.value);
  }
  ASSERT_EQ(got.size(), kWritten);
  for (std::uint32_t n = 0; n < kWritten; ++n) {
    EXPECT_EQ(got[n].burst_index, n);
    EXPECT_EQ(got[n].stop, n / 3);
  }
  EXPECT_EQ(next_sample(late_events).seq, kWritten - static_cast<std::uint32_t>(kQos<proto::Event>.history));
  EXPECT_EQ(axes.write({.rot_cmd_deg = 1000.0}).error().code, ErrorCode::kMessageInvalid);
}

TEST_F(DdsInProcess, a_wake_ends_the_wait) {
  auto reader = Reader<proto::Burst>::create(right_).value();
  EXPECT_EQ(reader.wait(0ns), Wake::kTimeout);
  reader.wake();
  EXPECT_EQ(reader.wait(20s), Wake::kWoken);
  EXPECT_EQ(reader.wait(0ns), Wake::kTimeout);
  std::thread other([&] {
    std::this_thread::sleep_for(50ms);
    reader.wake();
  });
  EXPECT_EQ(reader.wait(20s), Wake::kWoken);
  other.join();
}

TEST_F(DdsInProcess, a_value_beyond_its_bound_is_not_sent) {
  auto writer = Writer<proto::Event>::create(left_).value();
  EXPECT_EQ(writer.write({.text = std::string(201, 'x')}).error().code, ErrorCode::kMessageInvalid);
  EXPECT_TRUE(writer.write({.text = std::string(200, 'x')}));
  auto bursts = Writer<proto::Burst>::create(left_).value();
  EXPECT_EQ(bursts.write({.meta = std::vector<proto::FrameMeta>(9)}).error().code, ErrorCode::kMessageInvalid);
}

TEST(Dds, ends_outlive_their_participant) {
  auto participant = std::make_unique<Participant>(Participant::create({.tag = fresh_tag()}).value());
  auto writer = Writer<proto::Event>::create(*participant).value();
  participant.reset();
  EXPECT_TRUE(writer.write({.text = "still here"}));
}

TEST(Dds, a_wrong_configuration_is_an_error) {
  setenv("CYCLONEDDS_URI", "<CycloneDDS><Nonsense/></CycloneDDS>", 1);
  const auto participant = Participant::create({.domain = 79, .tag = fresh_tag()});
  unsetenv("CYCLONEDDS_URI");
  ASSERT_FALSE(participant);
  EXPECT_EQ(participant.error().code, ErrorCode::kDds);
}

}  // namespace
}  // namespace enamel::dds
