// A MODEL of a board: one clock makes the camera's frames, the edges on its lines and the projector's patterns, and the
// product's drivers run on them: BoardDevice with a fake request source, a modelled controller and a pipe of GPIO
// events.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/gpio.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstring>
#include <functional>
#include <memory>
#include <random>

#include "firmware/device/linux/board/board_device.hpp"
#include "tests/unit/firmware/dlpc347x_model.hpp"
#include "tests/unit/firmware/fake_request_source.hpp"
#include "tests/unit/firmware/virtual_clock.hpp"

namespace enamel::fw::test {

/// One frame time of the board, before it happens. Faults change it.
struct BoardStep {
  bool gate = false;  ///< strobes pass to the projector
  bool trigger_missed = false;
  bool frame_lost = false;   ///< completes with no trace but its sequence number
  bool number_lost = false;  ///< and that, too
  bool damaged = false;
  bool hold = false;  ///< completes after the next one
  bool twice = false;
  bool edges_lost = false;  ///< the kernel had no room
  bool extra_strobe = false;
  bool projector_restarts = false;
  bool stale = false;  ///< shows the pixels of the frame before
  std::int64_t stamp_error = 0;
};

class LightModel final : public Light {
 public:
  explicit LightModel(std::shared_ptr<std::atomic<bool>> lit = std::make_shared<std::atomic<bool>>(false))
      : lit_(std::move(lit)) {}
  void set_enabled(bool on) noexcept override { *lit_ = on; }
  [[nodiscard]] bool enabled() const noexcept override { return *lit_; }
  [[nodiscard]] int sensed_ma() const noexcept override { return *lit_ ? 400 : 0; }

 private:
  std::shared_ptr<std::atomic<bool>> lit_;
};
class ThermalModel final : public Thermal {
 public:
  [[nodiscard]] Temperatures read() const override { return {std::int16_t{3600}, {}, {}, std::int16_t{3000}}; }
};

class BoardModel {
 public:
  static constexpr std::int64_t kExposure = 3'776'000, kReadout = 100'000;
  static constexpr int kWidth = 16, kHeight = 2;

  BoardModel() {
    std::array<int, 2> pipe{};
    EXPECT_EQ(::pipe2(pipe.data(), O_NONBLOCK | O_CLOEXEC), 0);
    EXPECT_GT(::fcntl(pipe[1], F_SETPIPE_SZ, 1 << 20), 0);
    events_ = LineHandle(pipe[1]);
    auto bus = std::make_unique<Dlpc347xModel>();
    projector = bus.get();
    BoardParts parts;
    parts.camera = camera =
        std::make_shared<FakeRequestSource>(8, StreamFormat{kWidth, kHeight, 8, PixelFormat::kRaw8, 20});
    parts.bus = std::move(bus);
    parts.events = LineHandle(pipe[0]);
    parts.gate = [this](bool open) {
      gate_ = open;
      return true;
    };
    parts.follow_edges = false;
    parts.light = std::make_unique<LightModel>();
    parts.thermal = std::make_unique<ThermalModel>();
    auto made = BoardDevice::create(std::move(parts), profile(), "{}", clock);
    EXPECT_TRUE(made.has_value()) << made.error().message();
    if (made) device = std::move(*made);
    // A sequence that is stopped and started begins with pattern 0.
    projector->on_start = [this] { pattern_ = 0; };
  }

  static BoardProfile profile() {
    BoardProfile p;
    p.width = kWidth;
    p.height = kHeight;
    return p;
  }

  /// One strobe, and what follows from it. Returns how many frames can be fetched: other than 1 by faults.
  int step(const std::function<void(BoardStep&)>& harm = {}) {
    BoardStep s;
    s.gate = gate_;
    if (harm) harm(s);
    const std::int64_t t = t_;
    t_ += FakeRequestSource::kPeriod;
    if (s.projector_restarts) pattern_ = 0;
    // A dark frame is noise, and no two are alike.
    std::vector<std::uint8_t> pixels(20 * kHeight);
    for (auto& v : pixels) v = static_cast<std::uint8_t>(1 + noise_() % 3);
    event(t, p_.lines.strobe, true, s.edges_lost);
    if (s.extra_strobe) event(t + 900'000, p_.lines.strobe, true, false);
    if (s.gate && !s.trigger_missed && projector->triggered) {
      const int shown = pattern_;
      pattern_ = (pattern_ + 1) % 4;
      if (shown == 0) event(t + 20'000, p_.lines.t1, true, s.edges_lost);
      event(t + 221'000, p_.lines.t2, true, s.edges_lost);
      event(t + 221'000 + 3'464'000, p_.lines.t2, false, s.edges_lost);
      // What was really lit: a running number of exposures, and the pattern.
      std::fill(pixels.begin(), pixels.end(), static_cast<std::uint8_t>(100 + 10 * shown));
      std::memcpy(pixels.data(), &exposures_, sizeof exposures_);
      pixels[8] = static_cast<std::uint8_t>(shown);
    }
    ++exposures_;
    if (s.stale && !before_.empty()) pixels = before_;
    before_ = pixels;
    clock.sleep_until(host_time(t + kExposure + kReadout));
    return complete(s, t, pixels);
  }

  /// Exposure and pattern that a frame shows; nullopt for a dark one.
  static std::optional<std::pair<std::uint64_t, int>> shown_by(const CameraFrame& frame) {
    const auto row = frame.pixels.row(kWidth, 0);
    if (frame.pixels.row(kWidth, 1)[0] < 100) return std::nullopt;
    std::uint64_t exposure = 0;
    std::memcpy(&exposure, row.data(), sizeof exposure);
    return std::pair(exposure, static_cast<int>(row[8]));
  }

  VirtualClock clock;
  std::shared_ptr<FakeRequestSource> camera;
  Dlpc347xModel* projector = nullptr;
  std::unique_ptr<BoardDevice> device;

 private:
  void event(std::int64_t t, std::uint32_t line, bool rising, bool lost) {
    gpio_v2_line_event e{};
    e.timestamp_ns = static_cast<std::uint64_t>(t);
    e.id = rising ? GPIO_V2_LINE_EVENT_RISING_EDGE : GPIO_V2_LINE_EVENT_FALLING_EDGE;
    e.offset = line;
    e.seqno = ++seqno_;
    if (lost) return;
    EXPECT_EQ(::write(events_.fd(), &e, sizeof e), static_cast<ssize_t>(sizeof e));
  }
  int complete(const BoardStep& s, std::int64_t t, const std::vector<std::uint8_t>& pixels) {
    if (s.frame_lost) {
      if (!s.number_lost) camera->skip_sequence();
      return 0;
    }
    camera->content = [&](std::span<std::uint8_t> memory) { std::copy(pixels.begin(), pixels.end(), memory.begin()); };
    const auto fill = [&](Completion& c) {
      c.stamp_ns = t + kExposure + 20'000 + s.stamp_error;
      if (s.damaged) c.status = FrameStatus::kError;
      last_ = c;
    };
    if (s.hold) {
      camera->hold_next(fill);
      return 0;
    }
    if (!camera->deliver(fill)) {
      ADD_FAILURE() << "all buffers are lent";
      return 0;
    }
    const int held = camera->release_held();
    if (s.twice) camera->complete_again(last_);
    return 1 + held + (s.twice ? 1 : 0);
  }

  BoardProfile p_ = profile();
  LineHandle events_;
  bool gate_ = false;
  int pattern_ = 0;
  std::int64_t t_ = 2'000'000'000;
  std::uint64_t exposures_ = 0;
  std::uint32_t seqno_ = 0;
  std::vector<std::uint8_t> before_;
  Completion last_;
  std::mt19937 noise_{1};
};

}  // namespace enamel::fw::test
