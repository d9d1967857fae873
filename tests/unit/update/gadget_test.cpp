// Endpoint 0 to device half: what a port does that hosts and kernels do to it.
#include <gtest/gtest.h>

#include <deque>
#include <optional>
#include <vector>

#include "firmware/gadget/control_loop.hpp"
#include "tests/unit/update/update_probe.hpp"

namespace enamel::fw {
namespace {

using namespace std::chrono_literals;

/// Plays a host: events go out in order, answers are kept.
class ScriptedPort final : public ControlPort {
 public:
  struct Answer {
    bool stalled = false;
    std::vector<std::byte> data;
  };

  void event(PortEventKind kind) { events_.push_back({kind, {}}); }
  void setup(const SetupPacket& setup, std::span<const std::byte> data = {}) {
    events_.push_back({PortEventKind::kSetup, setup});
    data_.assign(data.begin(), data.end());
  }
  /// The host breaks off the next data stage: nothing of an OUT transfer's second half comes, an IN transfer's fails.
  void give_up_once() { give_up_ = true; }
  void die() { dead_ = true; }

  Result<std::optional<PortEvent>> next(std::chrono::milliseconds deadline) override {
    waited = deadline;
    if (dead_) return fail(ErrorCode::kGadget, "gone");
    if (events_.empty()) return std::nullopt;
    const PortEvent event = events_.front();
    events_.pop_front();
    return std::optional(event);
  }
  std::size_t receive(std::span<std::byte> data) override {
    const std::size_t n = std::exchange(give_up_, false) ? data.size() / 2 : data.size();
    std::copy_n(data_.begin(), n, data.begin());
    received += n;
    return n;
  }
  bool send(std::span<const std::byte> data) override {
    if (std::exchange(give_up_, false)) return false;
    answer = Answer{false, {data.begin(), data.end()}};
    return true;
  }
  bool acknowledge() override {
    answer = Answer{};
    return true;
  }
  void stall(const SetupPacket&) override { answer = Answer{true, {}}; }

  std::optional<Answer> answer;
  std::size_t received = 0;
  std::chrono::milliseconds waited{-1};

 private:
  std::deque<PortEvent> events_;
  std::vector<std::byte> data_;
  bool give_up_ = false;
  bool dead_ = false;
};

class Gadget : public Update {
 protected:
  void step() {
    port_.answer.reset();
    ASSERT_TRUE(loop().step(0ms).has_value());
  }
  void transfer(const SetupPacket& setup, std::span<const std::byte> data = {}) {
    port_.setup(setup, data);
    step();
  }
  DfuState status_state() {
    transfer({0xA1, 3, 0, 0, 6});
    return port_.answer && port_.answer->data.size() == 6 ? static_cast<DfuState>(port_.answer->data[4])
                                                          : DfuState::kAppIdle;
  }
  void block(std::span<const std::byte> image, std::size_t i) {
    const auto part = image.subspan(i * 4096, std::min<std::size_t>(4096, image.size() - i * 4096));
    transfer({0x21, 1, static_cast<std::uint16_t>(i), 0, static_cast<std::uint16_t>(part.size())}, part);
  }
  ControlLoop& loop() {
    if (!loop_) loop_.emplace(port_, *device_);
    return *loop_;
  }

  ScriptedPort port_;
  std::optional<ControlLoop> loop_;
};

TEST_F(Gadget, carries_a_download_to_its_end) {
  const auto image = make({2, 0, 0, 0}, 1);
  for (std::size_t i = 0; i * 4096 < image.size(); ++i) {
    block(image, i);
    ASSERT_EQ(status_state(), DfuState::kDownloadIdle) << i;
  }
  transfer({0x21, 1, 0, 0, 0});
  ASSERT_TRUE(port_.answer && !port_.answer->stalled);
  EXPECT_EQ(status_state(), DfuState::kManifest);
  int asked = 0;
  for (; status_state() == DfuState::kManifest; ++asked) {
    ASSERT_LT(asked, 20);
    ASSERT_TRUE(loop().step(500ms).has_value());
    if (device_->work_pending()) {
      EXPECT_EQ(port_.waited, 0ms) << "the next piece is due";
    }
  }
  EXPECT_GT(asked, 1) << "answered while the slot was read back";
  EXPECT_EQ(device_->position().state, DfuState::kIdle);
  ASSERT_TRUE(loop().step(500ms).has_value());
  EXPECT_EQ(port_.waited, 500ms) << "nothing is left to do";
  EXPECT_EQ(control().slot[1].state, SlotState::kPending);
}

TEST_F(Gadget, a_data_stage_that_is_broken_off_changes_nothing) {
  const auto image = make({2, 0, 0, 0}, 1);
  block(image, 0);
  ASSERT_EQ(status_state(), DfuState::kDownloadIdle);
  port_.give_up_once();
  block(image, 1);
  EXPECT_EQ(loop().counts().given_up, 1U);
  EXPECT_EQ(device_->position().state, DfuState::kDownloadIdle);
  block(image, 1);
  EXPECT_EQ(status_state(), DfuState::kDownloadIdle) << "the block was repeated";
}

TEST_F(Gadget, an_answer_that_was_lost_is_given_again) {
  block(make({2, 0, 0, 0}, 1), 0);
  port_.give_up_once();
  EXPECT_EQ(status_state(), DfuState::kAppIdle) << "no answer came";
  EXPECT_EQ(status_state(), DfuState::kDownloadIdle);
}

TEST_F(Gadget, a_bus_reset_ends_a_download_and_suspend_does_not) {
  const auto image = make({2, 0, 0, 0}, 1);
  for (const PortEventKind harmless :
       {PortEventKind::kBind, PortEventKind::kEnable, PortEventKind::kSuspend, PortEventKind::kResume}) {
    block(image, 0);
    ASSERT_EQ(status_state(), DfuState::kDownloadIdle);
    port_.event(harmless);
    step();
    EXPECT_EQ(device_->position().state, DfuState::kDownloadIdle);
    transfer({0x21, 6, 0, 0, 0});
  }
  for (const PortEventKind reset : {PortEventKind::kDisable, PortEventKind::kUnbind}) {
    block(image, 0);
    port_.event(reset);
    step();
    EXPECT_EQ(device_->position(), DfuPosition{});
  }
  EXPECT_EQ(loop().counts().resets, 2U);
}

TEST_F(Gadget, transfers_of_any_length_stay_inside_the_buffer) {
  transfer({0x21, 1, 0, 0, 4097});
  ASSERT_TRUE(port_.answer);
  EXPECT_TRUE(port_.answer->stalled);
  EXPECT_EQ(port_.received, 0U) << "nothing was read into the buffer";
  transfer({0xA1, 2, 0, 0, 0xFFFF});
  ASSERT_TRUE(port_.answer);
  EXPECT_EQ(port_.answer->data.size(), image::kStatusSize);
}

TEST_F(Gadget, a_refusal_is_a_stall) {
  transfer({0x41, static_cast<std::uint8_t>(VendorRequest::kRollback), 0, 0, 0});
  ASSERT_TRUE(port_.answer);
  EXPECT_TRUE(port_.answer->stalled) << "the other slot is empty";
  transfer({0xA1, 0x77, 0, 0, 1});
  EXPECT_TRUE(port_.answer->stalled);
  transfer({0x21, 4, 0, 0, 0});
  EXPECT_FALSE(port_.answer->stalled) << "CLRSTATUS leads back";
  EXPECT_EQ(loop().counts().stalled, 2U);
}

TEST_F(Gadget, a_port_that_is_gone_is_an_error) {
  port_.die();
  const auto step = loop().step(0ms);
  ASSERT_FALSE(step.has_value());
  EXPECT_EQ(step.error().code, ErrorCode::kGadget);
}

}  // namespace
}  // namespace enamel::fw
