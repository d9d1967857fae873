// 10 000 bursts, 100 000 in full form, with a fault in every hundredth frame: no frame ever lands in a foreign burst or
// place.
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "tests/support/full_form.hpp"
#include "tests/unit/firmware/device_run.hpp"

namespace enamel::fw::test {
namespace {

constexpr int kKinds = 18;

/// Makes trouble in one frame of a hundred, one kind at a time, and keeps what was true.
class Troublemaker {
 public:
  explicit Troublemaker(std::uint64_t seed, double share) : random_(seed), share_(share) {}

  void attach(SimDevice& device) {
    SimFaults faults;
    faults.on_step = [this](SimStep& s) { step(s); };
    faults.trigger_missed = [this](std::uint64_t, int) { return chance(share_ / kKinds); };
    device.set_faults(std::move(faults));
  }
  [[nodiscard]] DeviceTime true_start(std::uint64_t burst, std::size_t k) const { return starts_[burst % kKept][k]; }
  [[nodiscard]] std::uint64_t faults() const { return faults_; }

 private:
  static constexpr std::size_t kKept = 64;

  bool chance(double p) { return static_cast<double>(random_() >> 11U) * 0x1p-53 < p; }
  std::int64_t pick(std::int64_t n) { return static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(n)); }

  void step(SimStep& s) {
    if (s.position >= 0) starts_[s.burst_index % kKept][static_cast<std::size_t>(s.position)] = s.edges.front().t;
    for (CameraFrame& f : s.frames) f.sensor_seq += seq_shift_;
    std::optional<CameraFrame> held;
    held.swap(held_);
    if (chance(share_)) {
      ++faults_;
      harm(s, static_cast<int>(pick(kKinds)));
    }
    if (held) s.frames.push_back(std::move(*held));
    if (!s.frames.empty()) before_ = s.frames.back().pixels;
  }
  void harm(SimStep& s, int kind) {
    if (kind < 9) {
      harm_frame(s, kind);
    } else {
      harm_edges(s, kind);
    }
  }
  void harm_frame(SimStep& s, int kind) {
    CameraFrame& f = s.frames.front();
    switch (kind) {
      case 0:
        return s.frames.clear();
      case 1:
        --seq_shift_;
        return s.frames.clear();
      case 2:
        return s.frames.push_back(CameraFrame(f));
      case 3: {
        CameraFrame again = f;
        ++again.sensor_seq;
        ++seq_shift_;
        again.t_sensor += Nanoseconds{pick(kPeriodNs)};
        return s.frames.push_back(std::move(again));
      }
      case 4:
        held_ = std::move(f);
        return s.frames.clear();
      case 5:
        f.status = FrameStatus::kError;
        return;
      case 6:
        f.t_sensor += Nanoseconds{pick(4 * kPeriodNs) - 2 * kPeriodNs};
        return;
      case 7:
        f.exposure_us -= static_cast<std::uint32_t>(pick(3000));
        return;
      default:
        if (before_) f.pixels = *before_;
        return;
    }
  }
  void harm_edges(SimStep& s, int kind) {
    const DeviceTime any = s.edges.front().t + Nanoseconds{pick(kPeriodNs)};
    const auto lose = [&](EdgeKind k) { std::erase_if(s.edges, [&](const Edge& e) { return e.kind == k; }); };
    switch (kind) {
      case 9:
        return lose(EdgeKind::kStrobe);
      case 10:
        return s.edges.push_back({EdgeKind::kStrobe, any, 0});
      case 11:
        return lose(EdgeKind::kT1);
      case 12:
        return s.edges.push_back({EdgeKind::kT1, any, 0});
      case 13:
        return lose(EdgeKind::kT2Rise);
      case 14:
        return lose(EdgeKind::kT2Fall);
      case 15:
        s.edges.push_back({EdgeKind::kT2Rise, any, 0});
        return s.edges.push_back({EdgeKind::kT2Fall, any + Nanoseconds{pick(1'000'000)}, 0});
      case 16:
        for (Edge& e : s.edges) {
          if (e.kind != EdgeKind::kGate) e.t += std::chrono::hours(1);
        }
        return;
      default:
        for (CameraFrame& f : s.frames) {
          std::vector<std::uint8_t> pixels(f.pixels.bytes().size());
          for (auto& v : pixels) v = static_cast<std::uint8_t>(pick(2) * 60);
          f.pixels = PixelLoan(std::move(pixels));
        }
        return;
    }
  }

  std::mt19937_64 random_;
  double share_;
  std::array<std::array<DeviceTime, 4>, kKept> starts_{};
  std::uint32_t seq_shift_ = 0;
  std::optional<CameraFrame> held_;
  std::optional<PixelLoan> before_;
  std::uint64_t faults_ = 0;
};

/// Frames of `b` that show another burst or pattern than they claim. Frames without light say nothing.
int strangers(const AssembledBurst& b) {
  int n = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto tag = tag_of(b.frames[k].frame.pixels.bytes());
    if (tag && *tag != std::pair(b.burst_index, static_cast<int>(k))) ++n;
  }
  return n;
}

std::uint64_t burst_count() { return enamel::test::is_full_form() ? 100'000 : 10'000; }

TaggedSource::Config long_run(std::uint64_t count) {
  return {.count = count, .distances_ns = {20'020'000, 33'333'333, 24'024'000, 27'300'000}};
}

TEST(AssociationProperty, no_frame_lands_in_a_foreign_place_under_one_percent_faults) {
  const std::uint64_t bursts = burst_count();
  DeviceRun run(long_run(bursts));
  Troublemaker trouble(20240611, 0.01);
  trouble.attach(run.device());
  std::uint64_t whole = 0;
  std::uint64_t lost = 0;
  bool more = true;
  while (more) {
    more = run.step();
    for (const AssembledBurst& b : run.bursts) {
      ASSERT_EQ(strangers(b), 0) << "burst " << b.burst_index;
      for (std::size_t k = 0; k < 4; ++k) {
        const Nanoseconds error = b.frames[k].t_strobe - trouble.true_start(b.burst_index, k);
        ASSERT_LE(std::chrono::abs(error), Nanoseconds{100'000}) << "burst " << b.burst_index << " frame " << k;
      }
    }
    whole += run.bursts.size();
    lost += run.given_up.size();
    run.bursts.clear();
    run.given_up.clear();
  }
  EXPECT_EQ(run.assembler().begun(), bursts);
  EXPECT_EQ(whole + lost, bursts);  // every burst begun has exactly one outcome
  EXPECT_GT(trouble.faults(), bursts / 20);
  EXPECT_GT(lost, bursts / 50);         // the faults were felt …
  EXPECT_GT(whole, bursts * 85 / 100);  // … and cost little more than what they hit
  RecordProperty("whole", static_cast<int>(whole));
  RecordProperty("lost", static_cast<int>(lost));
}

TEST(AssociationProperty, without_faults_nothing_is_lost) {
  const std::uint64_t bursts = burst_count();
  DeviceRun run(long_run(bursts));
  std::uint64_t whole = 0;
  bool more = true;
  while (more) {
    more = run.step();
    whole += run.bursts.size();
    run.bursts.clear();
    ASSERT_TRUE(run.given_up.empty());
  }
  EXPECT_EQ(whole, bursts);
}

/// Negative control: who takes bright frames by fours, in order of arrival, mixes bursts under the same faults.
TEST(AssociationProperty, counting_frames_in_order_of_arrival_mixes_bursts) {
  DeviceRun run(long_run(2'000));
  Troublemaker trouble(20240611, 0.01);
  trouble.attach(run.device());
  std::vector<std::pair<std::uint64_t, int>> four;
  int mixed = 0;
  bool armed = false;
  for (;;) {
    if (!armed) armed = run.device().arm().has_value();
    const auto frame = run.device().next_frame();
    std::vector<Edge> edges;
    (void)run.device().read(edges);
    for (const Edge& e : edges) armed = armed && e.kind != EdgeKind::kGate;
    if (!frame) break;
    if (const auto tag = tag_of(frame->pixels.bytes())) four.push_back(*tag);
    if (four.size() < 4) continue;
    for (int k = 0; k < 4; ++k) mixed += four[static_cast<std::size_t>(k)] != std::pair(four[0].first, k) ? 1 : 0;
    four.clear();
  }
  EXPECT_GT(mixed, 100);
}

}  // namespace
}  // namespace enamel::fw::test
