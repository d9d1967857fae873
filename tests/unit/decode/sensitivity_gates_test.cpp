// The same for gates on whole bursts, for cuts of patterns without a code and for normals.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/decode/unwrap/least_cuts.hpp"
#include "tests/support/tooth_steps.hpp"
#include "tests/unit/decode/sensitivity.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::test {
namespace {

using pipeline::BurstVerdict;
constexpr int kWidth = 400, kHeight = 300;
constexpr double kTwoPi = 2 * std::numbers::pi;

struct Expected {
  FrameSet frames;
  std::optional<BurstVerdict> verdict;  ///< none: any that refuses
};

/// Rows of teeth at rest and moving, with frames in a wrong order, with one sent twice, and too fast, which mode M does
/// not tell from frames that do not belong together.
std::vector<Expected> good_and_bad(const calib::Rig& rig) {
  std::vector<Expected> out;
  for (const std::uint64_t seed : {3U, 27U}) {
    const ToothSteps steps = make_tooth_steps(cropped_rig(kWidth, kHeight), seed);
    const auto burst = [&](double motion_rad) {
      SceneOptions o = steps.options(seed);
      o.motion_rad = motion_rad;
      return render(
                 rig, [&](int u, int v) { return steps.depth_mm(u, v); }, o)
          .frames;
    };
    const FrameSet still = burst(0);
    FrameSet swapped = still, twice = still;
    std::swap(swapped.frames[2], swapped.frames[3]);
    twice.frames[3] = twice.frames[0];
    out.push_back({still, BurstVerdict::kAccepted});
    out.push_back({burst(0.1), BurstVerdict::kAccepted});
    const bool micro = rig.patterns.mode == calib::PatternMode::kMicro;
    out.push_back({burst(0.6), micro ? std::nullopt : std::optional(BurstVerdict::kTooFast)});
    out.push_back({std::move(swapped), BurstVerdict::kPatternMismatch});
    out.push_back({std::move(twice), BurstVerdict::kPatternMismatch});
  }
  return out;
}

/// placed: good bursts accepted; wrong: bad ones not refused as what they are. All agree: no slack.
Judge gates(bool micro) {
  const calib::Rig rig = micro ? micro_rig(kWidth, kHeight, kShippedRatio) : cropped_rig(kWidth, kHeight);
  return [rig, bursts = good_and_bad(rig)](const DecodeConfig& config) {
    const auto decoder = pipeline::BurstDecoder::make(rig, config).value();
    double good = 0, accepted = 0, missed = 0;
    for (const Expected& b : bursts) {
      const BurstVerdict verdict = decoder.decode(b.frames.view()).verdict;
      const bool right = verdict == b.verdict.value_or(verdict) && (b.verdict || verdict != BurstVerdict::kAccepted);
      const bool is_good = b.verdict == BurstVerdict::kAccepted;
      good += is_good ? 1 : 0, accepted += is_good && right ? 1 : 0, missed += is_good || right ? 0 : 1;
    }
    const Figures all{100 * accepted / good, 100 * missed / (static_cast<double>(bursts.size()) - good), 0};
    return std::vector<Figures>{all, all};
  };
}

std::vector<Member> common_gates() {
  return {times(ENAMEL_MEMBER(light.min_points)),
          times(ENAMEL_MEMBER(light.max_saturated_share)),
          rest_times(ENAMEL_MEMBER(frames.max_repeated_share)),
          rest_times(ENAMEL_MEMBER(linked.min_linked_share)),
          rest_times(ENAMEL_MEMBER(code.min_agreement)),
          times(ENAMEL_MEMBER(code.max_torn_share)),
          times(ENAMEL_MEMBER(odd_frame.max_shift_rad)),
          times(ENAMEL_MEMBER(odd_frame.max_over_unrest)),
          times(ENAMEL_MEMBER(odd_frame.max_unrest)),
          times(ENAMEL_MEMBER(wave_shape.max_third)),
          times(ENAMEL_MEMBER(motion.max_motion_rad))};
}

/// Every limit, where it refuses all.
std::vector<std::pair<Member, double>> common_controls() {
  return {{times(ENAMEL_MEMBER(light.min_points)), 1000},
          {times(ENAMEL_MEMBER(frames.max_repeated_share)), 0},
          {rest_times(ENAMEL_MEMBER(linked.min_linked_share)), 0},
          {rest_times(ENAMEL_MEMBER(code.min_agreement)), 0},
          {times(ENAMEL_MEMBER(motion.max_motion_rad)), 0}};
}

TEST(SensitivityOfGates, mode_t) {
  std::vector<Member> members = common_gates();
  members.push_back(rest_times(ENAMEL_MEMBER(four_step.closes.min_share)));
  members.push_back(rest_times(ENAMEL_MEMBER(four_step.closes.min_unplaced_share)));
  members.push_back(rest_times(ENAMEL_MEMBER(four_step.fast.min_moving_share)));
  members.push_back(times(ENAMEL_MEMBER(four_step.fast.least_motion_rad)));
  auto controls = common_controls();
  controls.emplace_back(rest_times(ENAMEL_MEMBER(four_step.closes.min_share)), 0);
  controls.emplace_back(times(ENAMEL_MEMBER(four_step.fast.least_motion_rad)), 10);
  expect_no_laws("gates T", gates(false), members, controls);
}

TEST(SensitivityOfGates, mode_m) {
  std::vector<Member> members = common_gates();
  members.push_back(rest_times(ENAMEL_MEMBER(micro.direction.min_share)));
  members.push_back(rest_times(ENAMEL_MEMBER(micro.direction.min_unplaced_share)));
  members.push_back(rest_times(ENAMEL_MEMBER(micro.direction.max_unplaced_repeated)));
  members.push_back(rest_times(ENAMEL_MEMBER(micro.explained.min_share)));
  auto controls = common_controls();
  controls.emplace_back(times(ENAMEL_MEMBER(micro.direction.min_share)), 2);
  expect_no_laws("gates M", gates(true), members, controls);
}

/// Height in fringes behind a bent cliff, away from every border, that grows from nothing to 1.6 fringes and back:
/// neighbours do not see where it is a whole fringe, and the shortest cut from one such place to the other leaves it.
double cliff(int u, int v) {
  const double along = std::numbers::pi * (v - 60) / 80.0, edge = 70 + 30 * std::sin(along);
  if (v < 60 || v > 140 || u < edge) return 0;
  return 1.6 * std::sin(along) * std::max(0.0, 1 - (u - edge) / 55.0);
}

struct Cliff {
  static constexpr int kAcross = 160, kDown = 200;
  pipeline::PhaseMaps phase;
  Map<float> carrier{kAcross, kDown};
  Map<double> truth{kAcross, kDown};
};

Cliff make_cliff(double sigma_rad) {
  Cliff out;
  out.phase.resize(Cliff::kAcross, Cliff::kDown);
  Normals normal(7);
  for (int v = 0; v < Cliff::kDown; ++v) {
    for (int u = 0; u < Cliff::kAcross; ++u) {
      out.truth(u, v) = kTwoPi * (u / 27.0 + cliff(u, v));
      out.carrier(u, v) = static_cast<float>(kTwoPi * u / 27.0);
      out.phase.phase_rad(u, v) = static_cast<float>(std::remainder(out.truth(u, v) + sigma_rad * normal(), kTwoPi));
      out.phase.sigma_rad(u, v) = static_cast<float>(sigma_rad);
      out.phase.reject(u, v) = pipeline::PixelReject::kNone;
    }
  }
  return out;
}

/// wrong: pixels of another number of turns than the corner.
Judge cliffs() {
  return [](const DecodeConfig& config) {
    std::vector<Figures> out;
    for (const double sigma_rad : {0.02, 0.06, 0.12}) {
      const Cliff c = make_cliff(sigma_rad);
      pipeline::LeastCutsWork work;
      pipeline::FloodMaps found;
      unwrap_by_least_cuts(c.phase, {c.carrier.pixels().data(), 0.23F, 0.23F}, config.four_step.cuts, work, found);
      const auto turns = [&](std::size_t i) {
        return std::lround((static_cast<double>(c.phase.phase_rad[i]) - c.truth[i]) / kTwoPi) + found.wraps[i];
      };
      double wrong = 0;
      for (std::size_t i = 0; i < c.truth.size(); ++i) wrong += turns(i) != turns(0) ? 1 : 0;
      out.push_back({100, 100 * wrong / static_cast<double>(c.truth.size()), 0});
    }
    return out;
  };
}

TEST(Sensitivity, cuts_lie_where_they_lie_under_any_like_prior) {
  expect_no_laws(
      "cuts", cliffs(),
      {times(ENAMEL_MEMBER(four_step.cuts.links_per_jump)), times(ENAMEL_MEMBER(four_step.cuts.curvature_rad)),
       times(ENAMEL_MEMBER(four_step.cuts.max_slope_rad))},
      {{times(ENAMEL_MEMBER(four_step.cuts.links_per_jump)), 1e-30},
       {times(ENAMEL_MEMBER(four_step.cuts.curvature_rad)), 100}});
}

/// Planes that face the camera, one 3 mm before the other. placed: pixels beside the edge that have a normal; error:
/// that these are off, rms, degrees.
Judge normals() {
  const calib::Rig rig = cropped_rig(kWidth, kHeight);
  std::vector<FrameSet> bursts;
  for (const double left_mm : {45.5, 48.5, 50.0}) {
    SceneOptions o = noisy();
    o.seed = static_cast<std::uint64_t>(left_mm);
    bursts.push_back(render(
                         rig, [&](int u, int) { return u < kWidth / 2 ? left_mm : 94 - left_mm; }, o)
                         .frames);
  }
  return [rig, bursts = std::move(bursts)](const DecodeConfig& config) {
    const auto decoder = pipeline::BurstDecoder::make(rig, config).value();
    std::vector<Figures> out;
    for (const FrameSet& frames : bursts) {
      const auto burst = decoder.decode(frames.view());
      double seen = 0, told = 0, squares = 0;
      for (int v = 0; v < kHeight; ++v) {
        for (int u = kWidth / 2 - 5; u < kWidth / 2 + 5; ++u) {
          if (!(burst.patch.depth_mm(u, v) > 0)) continue;
          seen += 1;
          const Eigen::Vector3f n = burst.patch.normals(u, v);
          if (!n.allFinite()) continue;
          told += 1, squares += static_cast<double>((n + Eigen::Vector3f::UnitZ()).squaredNorm());
        }
      }
      const double rms = std::sqrt(squares / std::max(told, 1.0));
      out.push_back({100 * told / std::max(seen, 1.0), 0, 180 / std::numbers::pi * rms});
    }
    return out;
  };
}

TEST(Sensitivity, normals_are_those_of_the_surface_under_any_like_limit_of_slope) {
  expect_no_laws("triangulate", normals(), {tangent_times(ENAMEL_MEMBER(normals.max_slope_deg))},
                 {{tangent_times(ENAMEL_MEMBER(normals.max_slope_deg)), 100}});
}

}  // namespace
}  // namespace enamel::test
