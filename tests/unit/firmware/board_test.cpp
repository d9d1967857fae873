// The drivers of a board together, on a MODEL of one: which frame saw which pattern, whatever goes wrong between them.
#include <gmock/gmock.h>

#include <random>

#include "firmware/acquire/assembler.hpp"
#include "firmware/acquire/sequencer.hpp"
#include "tests/support/full_form.hpp"
#include "tests/unit/firmware/board_model.hpp"

namespace enamel::fw::test {
namespace {

/// Four exposures in a row, patterns 0 to 3; anything else is a frame in a foreign place.
bool is_as_lit(const AssembledBurst& b) {
  const auto first = BoardModel::shown_by(b.frames[0].frame);
  if (!first) return false;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto shown = BoardModel::shown_by(b.frames[k].frame);
    if (shown != std::pair(first->first + k, static_cast<int>(k))) return false;
  }
  return true;
}

/// Runs a board into an assembler, as the acquisition thread does, in virtual time.
class BoardRun {
 public:
  BoardRun() : hw_(board.device->hardware()) {
    assembler_ = std::make_unique<BurstAssembler>(AssemblerConfig::for_mode(hw_.camera.mode(), Nanoseconds{20'000}));
    EXPECT_TRUE(hw_.camera.start().has_value());
    sequencer_.start();
  }
  void step(const std::function<void(BoardStep&)>& harm = {}) {
    if (sequencer_.want_arm()) {
      EXPECT_TRUE(hw_.projector.arm().has_value());
      sequencer_.on_armed();
    }
    const int frames = board.step(harm);
    for (int i = 0; i < std::max(1, frames); ++i) fetch(frames > 0);
    for (BurstOutcome& o : assembler_->take_outcomes()) {
      if (auto* whole = std::get_if<AssembledBurst>(&o)) {
        bursts.push_back({whole->burst_index, is_as_lit(*whole)});
      } else {
        ++given_up;
        EXPECT_TRUE(hw_.projector.restart().has_value());
      }
    }
  }
  [[nodiscard]] std::uint64_t begun() const { return assembler_->begun(); }
  [[nodiscard]] std::uint64_t under_way() const { return assembler_->under_way(); }

  BoardModel board;
  struct Whole {
    std::uint64_t index = 0;
    bool as_lit = false;
  };
  std::vector<Whole> bursts;  ///< without their frames, whose buffers the camera needs
  std::uint64_t given_up = 0;

 private:
  void fetch(bool has_frame) {
    std::optional<CameraFrame> frame;
    if (has_frame) {
      auto next = hw_.camera.next_frame();
      ASSERT_TRUE(next.has_value()) << next.error().message();
      frame = std::move(*next);
    }
    std::vector<Edge> edges;
    const DeviceTime known_until = hw_.edges.read(edges);
    for (const Edge& e : edges) {
      assembler_->push_edge(e);
      if (e.kind == EdgeKind::kGate) sequencer_.on_begun(1);
    }
    if (frame) {
      sequencer_.on_frame(frame->status == FrameStatus::kSuccess);
      assembler_->push_frame(std::move(*frame));
    }
    assembler_->edges_known_until(known_until);
  }

  Hardware hw_;
  std::unique_ptr<BurstAssembler> assembler_;
  Sequencer sequencer_;
};

std::uint64_t burst_count() { return enamel::test::is_full_form() ? 100'000 : 10'000; }

TEST(Board, without_faults_every_burst_is_whole) {
  BoardRun run;
  run.board.device->hardware().light.set_enabled(true);
  for (int i = 0; i < 8 * 2'000 + 20; ++i) run.step();
  EXPECT_GE(run.bursts.size(), 1'990U) << "four lit frames and four dark ones";
  EXPECT_EQ(run.given_up, 0U);
  EXPECT_LE(run.under_way(), 1U);
  for (std::size_t i = 0; i < run.bursts.size(); ++i) {
    ASSERT_TRUE(run.bursts[i].as_lit) << i;
    EXPECT_EQ(run.bursts[i].index, i);
  }
  EXPECT_EQ(run.board.device->lost_edges(), 0U);
}

/// One of twelve kinds of trouble.
void harm(BoardStep& s, std::mt19937_64& random) {
  switch (random() % 12) {
    case 0:
      s.trigger_missed = true;
      return;
    case 1:
      s.frame_lost = true;
      return;
    case 2:
      s.frame_lost = s.number_lost = true;
      return;
    case 3:
      s.damaged = true;
      return;
    case 4:
      s.hold = true;
      return;
    case 5:
      s.twice = true;
      return;
    case 6:
      s.edges_lost = true;
      return;
    case 7:
      s.extra_strobe = true;
      return;
    case 8:
      s.projector_restarts = true;
      return;
    case 9:
      s.stale = true;
      return;
    case 10:
      s.gate = !s.gate;  // a strobe too many or too few passes to the projector
      return;
    default:
      s.stamp_error = static_cast<std::int64_t>(random() % 8'000'000) - 4'000'000;
  }
}

TEST(Board, no_frame_lands_in_a_foreign_place_whatever_goes_wrong) {
  BoardRun run;
  std::mt19937_64 random(20261127);
  std::uint64_t faults = 0, whole = 0;
  const auto one_in_a_hundred = [&](BoardStep& s) {
    if (random() % 100 != 0) return;
    ++faults;
    harm(s, random);
  };
  const std::uint64_t wanted = burst_count();
  for (std::uint64_t i = 0; run.begun() < wanted && i < 40 * wanted; ++i) {
    run.step(one_in_a_hundred);
    for (const BoardRun::Whole& b : run.bursts) ASSERT_TRUE(b.as_lit) << "burst " << b.index;
    whole += run.bursts.size();
    run.bursts.clear();
  }
  EXPECT_EQ(whole + run.given_up + run.under_way(), run.begun()) << "one outcome each";
  EXPECT_GE(run.begun(), wanted);
  EXPECT_GT(faults, wanted / 20);
  EXPECT_GT(run.given_up, wanted / 50);
  EXPECT_GT(whole, wanted * 8 / 10);
  EXPECT_GT(run.board.device->lost_edges(), 0U);
  RecordProperty("whole", static_cast<int>(whole));
  RecordProperty("given_up", static_cast<int>(run.given_up));
}

TEST(Board, a_projector_that_restarted_by_itself_is_set_up_anew_under_its_ceiling) {
  BoardRun run;
  run.board.device->hardware().light.set_enabled(true);
  for (int i = 0; i < 100; ++i) run.step();
  const std::size_t before = run.bursts.size();
  const auto ceiling = run.board.projector->registers[dlpc::kWriteLedMaxCurrent];
  ASSERT_FALSE(ceiling.empty());
  run.board.projector->restarts_by_itself();
  for (int i = 0; i < 200; ++i) run.step();
  EXPECT_EQ(run.board.projector->registers[dlpc::kWriteLedMaxCurrent], ceiling);
  EXPECT_EQ(run.board.projector->leds, kBlueLed);
  EXPECT_GE(run.bursts.size(), before + 20);
  EXPECT_GE(run.given_up, 1U);
  EXPECT_LE(run.given_up, 3U);
  for (const auto& b : run.bursts) EXPECT_TRUE(b.as_lit);
}

/// Negative control: who takes lit frames by fours as they come mixes bursts under the same faults.
TEST(Board, counting_frames_in_order_of_arrival_mixes_bursts) {
  BoardModel board;
  Hardware hw = board.device->hardware();
  ASSERT_TRUE(hw.camera.start().has_value());
  std::mt19937_64 random(20261127);
  std::vector<std::pair<std::uint64_t, int>> four;
  int mixed = 0;
  for (int i = 0; i < 16'000; ++i) {
    hw.projector.disarm();
    ASSERT_TRUE(hw.projector.arm().has_value());
    const int frames = board.step([&](BoardStep& s) { s.frame_lost = random() % 100 == 0; });
    std::vector<Edge> edges;
    static_cast<void>(hw.edges.read(edges));
    if (frames == 0) continue;
    const auto frame = hw.camera.next_frame();
    ASSERT_TRUE(frame.has_value());
    if (const auto shown = BoardModel::shown_by(*frame)) four.push_back(*shown);
    if (four.size() < 4) continue;
    mixed += four[3].first != four[0].first + 3 || four[0].second != 0 ? 1 : 0;
    four.clear();
  }
  EXPECT_GT(mixed, 100);
}

TEST(Board, goes_dark_when_it_is_closed) {
  BoardModel board;
  EXPECT_EQ(board.projector->leds, kBlueLed);
  std::uint8_t leds = 0xFF;
  board.projector->on_leds = [&](std::uint8_t lit) { leds = lit; };
  board.device.reset();
  EXPECT_EQ(leds, 0);
}

TEST(Board, light_is_off_whatever_fails_at_the_start) {
  for (int fails_at : {0, 5, 10, 15, 20}) {
    auto bus = std::make_unique<Dlpc347xModel>();
    bus->refuses = [=](int n) { return n >= fails_at; };
    std::array<int, 2> pipe{};
    ASSERT_EQ(::pipe2(pipe.data(), O_NONBLOCK | O_CLOEXEC), 0);
    const LineHandle other(pipe[1]);
    bool gate = true;
    BoardParts parts;
    parts.camera = std::make_shared<FakeRequestSource>();
    parts.bus = std::move(bus);
    parts.events = LineHandle(pipe[0]);
    parts.gate = [&](bool open) {
      gate = open;
      return true;
    };
    const auto lit = std::make_shared<std::atomic<bool>>(true);
    parts.light = std::make_unique<LightModel>(lit);
    parts.thermal = std::make_unique<ThermalModel>();
    VirtualClock clock;
    const auto device = BoardDevice::create(std::move(parts), BoardModel::profile(), "{}", clock);
    EXPECT_FALSE(device.has_value()) << fails_at;
    EXPECT_FALSE(gate);
    EXPECT_FALSE(lit->load());
  }
}

}  // namespace
}  // namespace enamel::fw::test
