// A board whose projector is a LightCrafter 4500: the product's BoardDevice on a MODEL of its controller.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "tests/unit/firmware/board_model.hpp"
#include "tests/unit/firmware/dlpc350_model.hpp"

namespace enamel::fw::test {
namespace {

using testing::HasSubstr;

BoardProfile bench_profile() {
  BoardProfile p = BoardModel::profile();
  p.projector = ProjectorType::kDlpc350;
  p.limits = kDlpc350Limits;
  p.led_code = 60;
  p.timing.pattern = kDlpc350Timing;
  return p;
}

class Bench {
 public:
  explicit Bench(const std::function<void(Dlpc350Model&)>& harm = {}) {
    std::array<int, 2> pipe{};
    EXPECT_EQ(::pipe2(pipe.data(), O_NONBLOCK | O_CLOEXEC), 0);
    events_ = LineHandle(pipe[1]);
    auto hid = std::make_unique<Dlpc350Model>();
    projector = hid.get();
    if (harm) harm(*hid);
    BoardParts parts;
    parts.camera = std::make_shared<FakeRequestSource>();
    parts.hid = std::move(hid);
    parts.events = LineHandle(pipe[0]);
    parts.gate = [this](bool open) {
      gate = open;
      return true;
    };
    parts.follow_edges = false;
    parts.light = std::make_unique<LightModel>(lit);
    parts.thermal = std::make_unique<ThermalModel>();
    device = BoardDevice::create(std::move(parts), bench_profile(), "{}", clock);
  }
  VirtualClock clock;
  std::shared_ptr<std::atomic<bool>> lit = std::make_shared<std::atomic<bool>>(true);
  bool gate = true;
  Dlpc350Model* projector = nullptr;  ///< while the device lives
  Result<std::unique_ptr<BoardDevice>> device = fail(ErrorCode::kInternal);

 private:
  LineHandle events_;
};

TEST(Dlpc350Board, is_armed_lit_and_restarted) {
  Bench bench;
  ASSERT_TRUE(bench.device.has_value()) << bench.device.error().message();
  EXPECT_EQ(bench.projector->leds, 8);
  EXPECT_TRUE(bench.projector->runs);
  EXPECT_FALSE(bench.lit->load()) << "its line is another switch in the same current";
  const Hardware hw = (*bench.device)->hardware();
  EXPECT_TRUE(hw.projector.status().ready);
  const std::size_t before = bench.projector->messages.size();
  ASSERT_TRUE(hw.projector.restart().has_value());
  EXPECT_EQ(bench.projector->messages[before].back(), 0) << "stop";
  EXPECT_EQ(bench.projector->messages[before + 1].back(), 2) << "start: from pattern 0";
  EXPECT_FALSE(bench.gate);
  EXPECT_TRUE(hw.projector.status().ready);
  bench.projector->main = 1;
  EXPECT_FALSE(hw.projector.status().ready);
  bench.projector->unplugged_after = 0;
  EXPECT_FALSE(hw.projector.status().ready);
  EXPECT_FALSE(hw.projector.restart().has_value());
}

TEST(Dlpc350Board, goes_dark_when_it_is_closed) {
  Bench bench;
  ASSERT_TRUE(bench.device.has_value());
  std::uint8_t leds = 0xFF;
  bench.projector->on_leds = [&](std::uint8_t now) { leds = now; };
  bench.device->reset();
  EXPECT_EQ(leds, 0);
}

TEST(Dlpc350Board, light_is_off_wherever_it_is_unplugged_at_the_start) {
  int after = 0;
  for (bool is_open = false; !is_open && after < 1000; ++after) {
    Bench bench([&](Dlpc350Model& m) { m.unplugged_after = after; });
    is_open = bench.device.has_value();
    EXPECT_FALSE(bench.gate);
    EXPECT_FALSE(bench.lit->load());
  }
  EXPECT_GT(after, 30);
}

TEST(Dlpc350Board, profile_chooses_it) {
  const auto read = [](const std::string& projector, const std::string& camera = "") {
    const std::string path = testing::TempDir() + "/bench.toml";
    std::ofstream(path) << "[probe]\nrig = \"rig.json\"\n[sensors]\nled_current = \"/sys/ma\"\n[camera]\n"
                        << (camera.empty() ? "exposure_us = 8800\nframe_lines = 1000\n" : camera) << "[projector]\n"
                        << projector;
    return read_profile(path);
  };
  const auto why = [&](const std::string& projector, const std::string& camera = "") {
    const auto profile = read(projector, camera);
    return profile ? std::string("accepted") : profile.error().detail;
  };
  const auto bench = read("type = \"dlpc350\"\nhid = \"/dev/hidraw3\"\nimage = 2\n");
  ASSERT_TRUE(bench.has_value()) << bench.error().message();
  EXPECT_EQ(bench->projector, ProjectorType::kDlpc350);
  EXPECT_EQ(bench->hid, "/dev/hidraw3");
  EXPECT_EQ(bench->image, 2);
  EXPECT_EQ(bench->timing.pattern.illum_us, 8333U);
  EXPECT_EQ(bench->limits.max_led_code, 120);
  EXPECT_EQ(read("type = \"dlpc347x\"\n", "gain = 1.0\n")->projector, ProjectorType::kDlpc347x);

  const auto example = read_profile(ENAMEL_SOURCE_DIR "/config/probe/lightcrafter4500.toml");
  ASSERT_TRUE(example.has_value()) << example.error().message();
  EXPECT_EQ(example->projector, ProjectorType::kDlpc350);

  const auto unknown = read("type = \"dlpc900\"\n");
  ASSERT_FALSE(unknown.has_value());
  EXPECT_EQ(unknown.error().code, ErrorCode::kConfigValue);
  EXPECT_THAT(unknown.error().detail, HasSubstr("dlpc350"));
  const std::string type = "type = \"dlpc350\"\n";
  EXPECT_THAT(why(type + "bus = \"/dev/i2c-1\"\n"), HasSubstr("bus"));
  EXPECT_THAT(why("hid = \"any\"\n"), HasSubstr("hid"));
  EXPECT_THAT(why(type + "max_led_code = 256\n"), HasSubstr("max_led_code"));
  EXPECT_THAT(why(type + "image = 63\n"), HasSubstr("image"));
  EXPECT_THAT(why(type + "illum_us = 8000\n"), HasSubstr("8 bits take 8333 us"));
  EXPECT_THAT(why(type + "post_us = 100\n"), HasSubstr("black behind a pattern takes 230 us"));
  EXPECT_THAT(why(type, "gain = 1.0\n"), HasSubstr("the exposure ends after 3776 us"));
}

}  // namespace
}  // namespace enamel::fw::test
