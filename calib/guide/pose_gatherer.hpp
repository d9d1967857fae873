// Pattern sets as a probe shows them, over and over, to still poses: a pose is a number of whole sweeps through all
// sets during which the target did not move, averaged.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "calib/io/calib_folder.hpp"

namespace enamel::calib {

/// Order of the sets of a rig of mode multi: 0 shows white, black, white, black; 1 … n fringes along u by rising
/// cycles, n + 1 … 2n along v.
struct MultiSets {
  std::vector<int> cycles;
  [[nodiscard]] int count() const { return 1 + 2 * static_cast<int>(cycles.size()); }
};

/// From `patterns.cycles` of the rig's text. Error: kPatternSet when the rig is not of mode multi or states no rising
/// cycles that begin with one.
[[nodiscard]] Result<MultiSets> multi_sets(const Rig& rig);

/// What became of the frames handed over last.
enum class GatherEvent : std::uint8_t {
  kNothing,
  kMoved,  ///< the target had rested for two sweeps or more, and moved before there were enough
  kPose,   ///< a pose is complete: take() it
};

/// One thread.
class PoseGatherer {
 public:
  /// sweeps: how many make a pose. noise: of one frame, to tell motion from noise.
  PoseGatherer(MultiSets sets, int sweeps, PixelNoise noise) : sets_(std::move(sets)), sweeps_(sweeps), noise_(noise) {}

  /// The four frames of one burst, DN. A set out of turn (a burst was lost) drops the sweep under way.
  GatherEvent add(int set, const std::array<Map<float>, 4>& frames);

  /// Means over the sweeps of the pose that kPose announced. Nothing more is gathered until the target moves.
  [[nodiscard]] PoseFrames take();

  [[nodiscard]] int sweeps_so_far() const { return gathered_; }
  [[nodiscard]] int sweeps_wanted() const { return sweeps_; }
  [[nodiscard]] std::uint64_t broken_sweeps() const { return broken_; }

 private:
  using Sets = std::vector<std::array<Map<float>, 4>>;
  [[nodiscard]] GatherEvent end_of_sweep();
  /// How a sweep begins and how it ends: both the same as in the pose's first sweep means that nothing moved between.
  struct Look {
    Map<float> white;
    Map<float> even;  ///< mean of the last set's four steps: an even light
  };
  [[nodiscard]] Look look() const;
  [[nodiscard]] bool is_changed(const Map<float>& now, const Map<float>& before, int averaged) const;
  [[nodiscard]] bool moved(const Look& now) const;

  MultiSets sets_;
  int sweeps_;
  PixelNoise noise_;
  Sets sweep_;                     ///< under way
  Sets sum_;                       ///< of the pose's sweeps
  std::optional<Look> reference_;  ///< of the pose's first sweep
  int gathered_ = 0;
  bool is_taken_ = false;  ///< the reference is that of a pose already handed out
  std::uint64_t broken_ = 0;
};

}  // namespace enamel::calib
