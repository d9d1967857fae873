// Rates over bursts of randomly drawn units, scenes, paints and motions. bench/decode_draws does the same by thousands.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <ostream>
#include <utility>
#include <vector>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/support/draw/faults.hpp"
#include "tests/support/draw/judge.hpp"
#include "tests/support/draw/ready.hpp"
#include "tests/support/full_form.hpp"

namespace enamel::test {
namespace {

using calib::PatternMode;

/// Which draws a decoder answers for, and how well. A wider promise is a changed line of kPromises.
struct Promise {
  PatternMode mode = PatternMode::kMicro;
  double highest_gamma = 1;  ///< of a pure gamma; the nearly linear are always in
  bool s_shaped = false;
  double accepted = 0, covered = 0;               ///< at least: of true bursts; of the sure pixels of those accepted
  double wrong = 0, bursts_with_large_wrong = 0;  ///< at most: of placed pixels; of accepted bursts
  double lowest_rms = 0.9, highest_rms = 1.15;    ///< of depth error over sigma, away from edges
};

constexpr Promise kPromises[] = {
    {.mode = PatternMode::kMicro, .highest_gamma = 1.3, .accepted = 0.9, .covered = 0.9, .wrong = 0.001},
    {.mode = PatternMode::kPolarity,
     .highest_gamma = 1.3,
     .accepted = 0.9,
     .covered = 0.8,
     .wrong = 0.002,
     .bursts_with_large_wrong = 0.12},
};

std::ostream& operator<<(std::ostream& out, const Promise& p) {
  return out << (p.mode == PatternMode::kMicro ? "M" : "T") << " to gamma " << p.highest_gamma;
}

bool is_promised(const Promise& p, const Drawn& d) {
  if (d.response.kind == ResponseKind::kS) return p.s_shaped;
  return d.response.kind == ResponseKind::kBow || d.response.gamma <= p.highest_gamma;
}

/// The middle of the picture, at most 240 x 180 pixels.
void crop(calib::LensValues& camera) {
  const int width = std::min(camera.width, 240), height = std::min(camera.height, 180);
  const int left = (camera.width - width) / 2, up = (camera.height - height) / 2;
  camera.cx -= left, camera.cy -= up;
  camera.width = width, camera.height = height;
}

int bursts() { return is_full_form() ? 400 : 40; }

struct Rates {
  int all = 0, accepted = 0, large_wrong = 0;
  std::size_t sure = 0, covered = 0, placed = 0, wrong = 0;
  ZScores smooth;

  void add(const Judged& j) {
    ++all;
    if (!j.accepted()) return;
    ++accepted;
    sure += j.sure, covered += j.sure_covered, placed += j.placed, wrong += j.wrong;
    large_wrong += j.largest_wrong > kLargeWrongRegion_px ? 1 : 0;
    smooth += j.z[static_cast<std::size_t>(PixelKind::kSmooth)];
  }
  [[nodiscard]] double accepted_share() const { return static_cast<double>(accepted) / all; }
};

using Change = std::function<void(calib::Rig&)>;
using Look = std::function<void(const Drawn&, const DrawnBurst&, const pipeline::BurstDecoder&)>;

/// What decoders make of `count` true bursts; `told` changes what they are told of the rig. look: at each burst.
Rates decode_draws(const Promise& promise, int count, const Change& told, const Look& look = {}) {
  Rates rates;
  pipeline::DecodeWorkspace workspace;
  pipeline::DecodedBurst decoded;
  for (std::uint64_t seed = 1; rates.all < count; ++seed) {
    if (!is_promised(promise, draw(seed, promise.mode))) continue;
    Drawn drawn = ready_draw(seed, promise.mode).drawn;
    if (!is_promised(promise, drawn)) continue;
    crop(drawn.rig.camera);
    calib::Rig rig = drawn.rig;
    told(rig);
    const auto decoder = pipeline::BurstDecoder::make(rig);
    const DrawnBurst burst = render(drawn);
    if (!decoder) continue;
    decoder->decode(burst.frames.view(), workspace, decoded);
    const Judged judged = judge(drawn, burst.truth, decoded);
    if (!judged.is_true_burst()) continue;
    rates.add(judged);
    if (look && judged.accepted()) look(drawn, burst, *decoder);
  }
  return rates;
}

void nothing_else(calib::Rig& /*rig*/) {}

class DrawnBursts : public testing::TestWithParam<Promise> {};

TEST_P(DrawnBursts, are_decoded_whole_and_right_with_the_sigma_that_is_told) {
  const Promise& p = GetParam();
  const Rates r = decode_draws(p, bursts(), nothing_else);
  EXPECT_GE(r.accepted_share(), p.accepted);
  EXPECT_GE(Judged::share(r.covered, r.sure), p.covered);
  EXPECT_LE(Judged::share(r.wrong, r.placed), p.wrong);
  EXPECT_LE(r.large_wrong, p.bursts_with_large_wrong * r.accepted);
  EXPECT_GE(r.smooth.rms(), p.lowest_rms);
  EXPECT_LE(r.smooth.rms(), p.highest_rms);
  RecordProperty("accepted", std::to_string(r.accepted_share()));
  RecordProperty("covered", std::to_string(Judged::share(r.covered, r.sure)));
  RecordProperty("wrong", std::to_string(Judged::share(r.wrong, r.placed)));
  RecordProperty("large_wrong", r.large_wrong);
  RecordProperty("rms", std::to_string(r.smooth.rms()));
}

/// Told twice the noise that there is. Told half of it, a decoder may find the rest in the burst.
TEST_P(DrawnBursts, show_a_noise_model_that_is_off_by_two) {
  const Promise& p = GetParam();
  const Rates r = decode_draws(p, bursts() / 4, [](calib::Rig& rig) {
    rig.noise->gain_e_per_dn *= 0.25;  // shot noise grows with the root, read noise in proportion
    rig.noise->read_noise_e *= 0.5;
  });
  EXPECT_GT(r.accepted, 0);
  EXPECT_LT(r.smooth.rms(), p.lowest_rms);
}

TEST_P(DrawnBursts, are_rejected_or_wrong_with_a_period_that_is_off) {
  const Promise& p = GetParam();
  const Rates r = decode_draws(p, bursts() / 4, [](calib::Rig& rig) { rig.patterns.period_px *= 1.15; });
  EXPECT_TRUE(r.accepted_share() < p.accepted || Judged::share(r.wrong, r.placed) > p.wrong)
      << r.accepted_share() << " " << Judged::share(r.wrong, r.placed);
}

TEST_P(DrawnBursts, with_frames_repeated_or_in_the_wrong_places_mislead_nobody) {
  constexpr double kMisled = 0.01;
  pipeline::DecodeWorkspace workspace;
  pipeline::DecodedBurst decoded;
  int faults = 0;
  decode_draws(GetParam(), bursts() / 4, nothing_else,
               [&](const Drawn& drawn, const DrawnBurst& burst, const pipeline::BurstDecoder& decoder) {
                 for (const FrameFault fault : {FrameFault::kRepeated, FrameFault::kPermuted}) {
                   const FaultedBurst bad = faulted(drawn, burst.frames, fault, drawn.seed);
                   decoder.decode(bad.frames.view(), workspace, decoded);
                   EXPECT_LE(judge(drawn, burst.truth, decoded).misled_share(), kMisled)
                       << drawn.seed << ": " << bad.what;
                   ++faults;
                 }
               });
  EXPECT_GT(faults, 0);
}

INSTANTIATE_TEST_SUITE_P(Modes, DrawnBursts, testing::ValuesIn(kPromises));

/// Where frame 3's sign is minus it is frame 1: half of the picture is as good as before.
TEST(DrawnSwap, frames_1_and_3_in_each_others_place_are_told_by_what_runs_backwards) {
  pipeline::DecodeConfig blind;  // the control
  blind.four_step.runs = {.min_direction_share = 0, .sound_linked_share = 0};
  blind.four_step.min_odd_blocks = 0;
  constexpr std::array<std::uint64_t, 5> kSeeds = {800034, 800043, 800046, 800124, 800146};
  std::size_t told = 0, taken_blindly = 0;
  for (const std::uint64_t seed : kSeeds) {
    const ReadyDraw ready = ready_draw(seed, PatternMode::kPolarity);
    FrameSet frames = render(ready.drawn, {.with_truth = false}).frames;
    EXPECT_TRUE(ready.decoder->decode(frames.view()).accepted()) << seed;
    std::swap(frames.frames[1], frames.frames[3]);
    told += ready.decoder->decode(frames.view()).accepted() ? 0U : 1U;
    const auto control = pipeline::BurstDecoder::make(ready.drawn.rig, blind);
    taken_blindly += control->decode(frames.view()).accepted() ? 1U : 0U;
  }
  EXPECT_EQ(told, kSeeds.size());
  EXPECT_GT(taken_blindly, 0);
}

/// With the code frame among them the three phase frames are those of no cosine; links, code and motion find nothing
/// wrong with some of them.
TEST(DrawnSwap, code_frame_in_a_phase_frames_place_is_told_by_direction_or_waveform) {
  struct Swap {
    std::uint64_t seed;
    FrameOrder order;
  };
  constexpr std::array<Swap, 6> kSwaps = {{{62001, {2, 0, 3, 1}},
                                           {62012, {3, 0, 1, 2}},
                                           {62021, {2, 3, 1, 0}},
                                           {63118, {3, 2, 0, 1}},
                                           {63121, {2, 3, 1, 0}},
                                           {63130, {3, 2, 0, 1}}}};
  pipeline::DecodeConfig blind;  // the control
  blind.micro.direction.min_share = 0.6, blind.wave_shape.max_third = 1;
  std::size_t taken_blindly = 0;
  for (const Swap& swap : kSwaps) {
    const ReadyDraw ready = ready_draw(swap.seed, PatternMode::kMicro);
    const FrameSet clean = render(ready.drawn, {.with_truth = false}).frames;
    EXPECT_TRUE(ready.decoder->decode(clean.view()).accepted()) << swap.seed;
    const FrameSet mixed = in_order(clean, swap.order);
    EXPECT_EQ(ready.decoder->decode(mixed.view()).verdict, pipeline::BurstVerdict::kPatternMismatch) << swap.seed;
    const auto control = pipeline::BurstDecoder::make(ready.drawn.rig, blind);
    taken_blindly += control->decode(mixed.view()).accepted() ? 1U : 0U;
  }
  EXPECT_GT(taken_blindly, 0U);
}

TEST(Draw, gives_the_same_frames_for_the_same_seed_and_others_for_another) {
  const auto frames = [](std::uint64_t seed) {
    Drawn drawn = draw(seed, PatternMode::kMicro);
    drawn.rig.camera.width = drawn.rig.camera.height = 40;
    return render(drawn).frames.frames;
  };
  EXPECT_EQ(frames(3), frames(3));
  EXPECT_NE(frames(3), frames(4));
}

TEST(Draw, reaches_every_class_of_condition) {
  std::array<int, kResponseClasses> responses{};
  std::array<int, kScenes> scenes{};
  std::array<int, kMotionBands> motions{};
  std::array<int, kAlbedoBands> albedos{};
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Drawn d = draw(seed, PatternMode::kPolarity);
    ++responses[static_cast<std::size_t>(response_class(d))], ++scenes[static_cast<std::size_t>(d.scene.kind)];
    ++motions[static_cast<std::size_t>(motion_band(d))], ++albedos[static_cast<std::size_t>(albedo_band(d))];
  }
  const auto least = [](const auto& counts) { return *std::min_element(counts.begin(), counts.end()); };
  EXPECT_GT(std::min({least(responses), least(scenes), least(motions), least(albedos)}), 10);
}

/// Turning balls and teeth, gum and few fringes: what is left of their motion, light and waveform looks like a frame of
/// another time in some blocks.
TEST(DrawnSurfaces, that_move_or_show_few_fringes_are_not_taken_for_an_odd_frame) {
  for (const std::uint64_t seed : {300064U, 300178U}) {
    const ReadyDraw ready = ready_draw(seed, PatternMode::kMicro);
    const DrawnBurst burst = render(ready.drawn);
    const Judged judged = judge(ready.drawn, burst.truth, ready.decoder->decode(burst.frames.view()));
    EXPECT_TRUE(judged.is_true_burst()) << seed;
    EXPECT_TRUE(judged.accepted()) << seed << " " << name_of(judged.verdict);
    EXPECT_LE(judged.wrong_share(), 0.001) << seed;
  }
}

}  // namespace
}  // namespace enamel::test
