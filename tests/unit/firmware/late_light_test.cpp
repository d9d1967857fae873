// Light that is made after its exposure, because it depends on when that was.
#include <gtest/gtest.h>

#include <cstring>
#include <utility>
#include <vector>

#include "firmware/device/sim/sim_device.hpp"
#include "tests/unit/firmware/tagged_source.hpp"
#include "tests/unit/firmware/virtual_clock.hpp"

namespace enamel::fw::test {
namespace {

constexpr Nanoseconds kRender{700'000'000};

/// Tagged bursts whose frames are made by `expose`, which takes its time.
class LateSource final : public BurstSource {
 public:
  LateSource(VirtualClock& clock, std::vector<SimExposure>& exposed) : clock_(clock), exposed_(exposed) {}
  [[nodiscard]] const std::string& rig_text() const override { return tagged_.rig_text(); }
  [[nodiscard]] std::optional<std::uint64_t> count() const override { return std::nullopt; }
  [[nodiscard]] Nanoseconds lateness() const override { return kRender; }
  [[nodiscard]] Result<std::optional<SimBurst>> next() override {
    ENAMEL_TRY_ASSIGN(auto burst, tagged_.next());
    burst->expose = [this, frames = std::exchange(burst->frames, {})](const SimExposure& when) {
      EXPECT_GE(to_ns(clock_.now()), to_ns(when.mid + (when.mid - when.first))) << "the exposure is not over";
      exposed_.push_back(when);
      clock_.sleep_for(kRender);
      if (meanwhile) meanwhile();
      return frames;
    };
    return burst;
  }
  static inline std::function<void()> meanwhile = {};

 private:
  TaggedSource tagged_{{.count = 50}};
  VirtualClock& clock_;
  std::vector<SimExposure>& exposed_;
};

class LateLight : public ::testing::Test {
 protected:
  void SetUp() override {
    LateSource::meanwhile = {};
    auto made = SimDevice::create(std::make_unique<LateSource>(clock_, exposed_), clock_, {.read_ahead = 0});
    ASSERT_TRUE(made);
    device_ = std::move(*made);
    ASSERT_TRUE(device_->start());
    ASSERT_TRUE(device_->restart());
    device_->set_enabled(true);
  }
  void TearDown() override { LateSource::meanwhile = {}; }
  VirtualClock clock_;
  std::vector<SimExposure> exposed_;
  std::unique_ptr<SimDevice> device_;
};

TEST_F(LateLight, comes_late_with_the_stamps_of_its_exposure) {
  EXPECT_EQ(device_->lateness(), kRender);
  std::size_t lit = 0;
  DeviceTime last{};
  for (int i = 0; i < 200 && lit < 20; ++i) {
    if (lit % 4 == 0) {
      ASSERT_TRUE(device_->arm());
    }
    const auto frame = device_->next_frame();
    ASSERT_TRUE(frame);
    EXPECT_GT(frame->t_sensor, last) << "stamps do not go back";
    last = frame->t_sensor;
    const auto tag = tag_of(frame->pixels.bytes());
    if (!tag) continue;
    EXPECT_EQ(*tag, (std::pair<std::uint64_t, int>(lit / 4, static_cast<int>(lit % 4))));
    const SimExposure& when = exposed_.at(lit / 4);
    const Nanoseconds period{kPeriodNs}, exposure{3'700'000}, stamp{20'000};
    EXPECT_EQ(frame->t_sensor, when.first + static_cast<int>(lit % 4) * period + exposure + stamp);
    EXPECT_EQ(when.mid - when.first, (3 * period + exposure) / 2);
    ++lit;
  }
  EXPECT_EQ(lit, 20U);
  EXPECT_EQ(exposed_.size(), 5U) << "made once a burst";
}

TEST_F(LateLight, is_exposed_as_long_as_asked_and_says_so) {
  const auto lit_exposures = [&](int frames) {
    std::vector<std::uint32_t> out;
    for (int i = 0; i < 200 && std::cmp_less(out.size(), frames); ++i) {
      if (out.size() % 4 == 0) {
        EXPECT_TRUE(device_->arm());
      }
      const auto frame = device_->next_frame();
      if (frame && tag_of(frame->pixels.bytes())) out.push_back(frame->exposure_us);
    }
    return out;
  };
  EXPECT_EQ(lit_exposures(4), std::vector<std::uint32_t>(4, 3700));
  EXPECT_EQ(exposed_.back().share, 1);
  ASSERT_TRUE(device_->set_exposure(925));
  EXPECT_EQ(lit_exposures(4), std::vector<std::uint32_t>(4, 925));
  EXPECT_EQ(exposed_.back().share, 0.25);
  EXPECT_EQ(exposed_.back().mid - exposed_.back().first, (3 * Nanoseconds{kPeriodNs} + Nanoseconds{925'000}) / 2);
  for (const std::uint32_t wrong : {1U, 4000U, 4'000'000'000U}) {
    const auto set = device_->set_exposure(wrong);
    ASSERT_FALSE(set) << wrong;
    EXPECT_EQ(set.error().code, ErrorCode::kConfigValue);
  }
  EXPECT_EQ(lit_exposures(4), std::vector<std::uint32_t>(4, 925)) << "what is refused changes nothing";
  ASSERT_TRUE(device_->set_exposure(0));
  EXPECT_EQ(lit_exposures(4), std::vector<std::uint32_t>(4, 3700));
}

TEST(EarlyLight, cannot_be_exposed_otherwise) {
  VirtualClock clock;
  auto made = SimDevice::create(std::make_unique<TaggedSource>(TaggedSource::Config{}), clock, {.read_ahead = 0});
  ASSERT_TRUE(made);
  EXPECT_EQ((*made)->set_exposure(925).error().code, ErrorCode::kHal);
  EXPECT_TRUE((*made)->set_exposure(0));
}

TEST_F(LateLight, a_stop_meanwhile_gives_the_burst_up) {
  LateSource::meanwhile = [this] { device_->stop(); };
  ASSERT_TRUE(device_->arm());
  for (int i = 0; i < 50; ++i) {
    const auto frame = device_->next_frame();
    if (!frame) {
      EXPECT_EQ(frame.error().code, ErrorCode::kCancelled);
      EXPECT_EQ(exposed_.size(), 1U);
      return;
    }
    EXPECT_FALSE(tag_of(frame->pixels.bytes()));
  }
  FAIL() << "it goes on";
}

}  // namespace
}  // namespace enamel::fw::test
