// What a stage is compared with, on the same bursts in the same minute: libraries, and plain loops for what the machine
// allows. All on one thread, times of the processor.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/types/geometry.hpp"
#include "pipeline/types/patch.hpp"
#include "tests/bench/speed/instruction_counter.hpp"
#include "tests/bench/speed/recording.hpp"
#include "tests/bench/thread_time.hpp"

namespace enamel::bench {

/// A burst of the recording, decoded and placed by the pipeline.
struct PlacedPatch {
  SurfacePatch patch;
  Pose T_model_cam = Pose::Identity();
};

/// Up to `most` bursts that were fused one after the other, from the middle of the recording.
[[nodiscard]] Result<std::vector<PlacedPatch>> placed_patches(const Recording& recording,
                                                              const std::vector<host::PlacedPose>& poses,
                                                              std::size_t most);

struct PeerCost {
  double ms = 0;            ///< core time
  double instructions = 0;  ///< user mode; 0 without a counter
};
/// Of this thread.
[[nodiscard]] inline PeerCost spent() {
  thread_local InstructionCounter counter;
  thread_local const bool counted = counter.open();
  return {.ms = thread_ms(), .instructions = counted ? static_cast<double>(counter.value()) : 0};
}
/// The least of n calls, for one of `parts` equal parts of a call.
template <class F>
[[nodiscard]] PeerCost least_of(int n, std::size_t parts, F&& call) {
  PeerCost least;
  const auto share = 1 / static_cast<double>(parts);
  for (int i = 0; i < n; ++i) {
    const PeerCost begun = spent();
    call();
    const PeerCost ended = spent();
    const PeerCost took{share * (ended.ms - begun.ms), share * (ended.instructions - begun.instructions)};
    least = i == 0 ? took : PeerCost{std::min(least.ms, took.ms), std::min(least.instructions, took.instructions)};
  }
  return least;
}

/// OpenCV: two subtract() and one cartToPolar() of a burst's four frames. 8-bit raw bursts.
[[nodiscard]] PeerCost phase_by_opencv(const proto::Burst& burst, int repeats);
/// Four frames of one byte and two maps of floats: 12 B a pixel copied.
[[nodiscard]] PeerCost copy_maps(const proto::Burst& burst, int repeats);

struct IcpLoopCost {
  PeerCost cost;
  std::size_t points = 0;
  int rounds = 0;
  double pairs = 0;     ///< over all rounds
  double apart_um = 0;  ///< of the loop's pose from the pipeline's, at the middle of the patch
};
/// Projective point-to-plane ICP of one patch on another, from a start off by 0.2 mm and 0.5 degrees: some 19 000
/// points, 18 rounds, single precision. reference, moving: of one rig.
[[nodiscard]] IcpLoopCost icp_loop(const calib::LensValues& lens, const PlacedPatch& reference,
                                   const PlacedPatch& moving, int repeats);

struct TsdfLoopCost {
  PeerCost cost;      ///< a patch
  double voxels = 0;  ///< written, a patch
  double off_um = 0;  ///< median distance of the last patch's points from the zero crossing
};
/// Truncated signed distances in a dense grid about all patches; of each patch, 8^3 cells near its surface.
[[nodiscard]] TsdfLoopCost tsdf_loop(const calib::LensValues& lens, const std::vector<PlacedPatch>& patches,
                                     double voxel_mm, double truncation_mm, int repeats);

/// OpenCV's HashTSDF on the same depth maps; nullopt where OpenCV was built without it. A patch.
[[nodiscard]] std::optional<PeerCost> hash_tsdf(const calib::LensValues& lens, const std::vector<PlacedPatch>& patches,
                                                double voxel_mm, double truncation_mm, int repeats);

}  // namespace enamel::bench
