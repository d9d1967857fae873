// What a stage is compared with, on the same bursts in the same minute: libraries, and plain loops for what the machine
// allows. All on one thread, times of the processor.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/types/geometry.hpp"
#include "pipeline/types/patch.hpp"
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

/// Least core time of n calls, ms.
template <class F>
[[nodiscard]] double best_ms(int n, F&& call) {
  double best = 0;
  for (int i = 0; i < n; ++i) {
    const double begun = thread_ms();
    call();
    const double took = thread_ms() - begun;
    if (i == 0 || took < best) best = took;
  }
  return best;
}

/// OpenCV: two subtract() and one cartToPolar() of a burst's four frames. 8-bit raw bursts.
[[nodiscard]] double phase_by_opencv_ms(const proto::Burst& burst, int repeats);
/// Four frames of one byte and two maps of floats: 12 B a pixel copied.
[[nodiscard]] double copy_ms(const proto::Burst& burst, int repeats);

struct IcpLoopCost {
  double ms = 0;
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
  double ms = 0;      ///< a patch
  double voxels = 0;  ///< written, a patch
  double off_um = 0;  ///< median distance of the last patch's points from the zero crossing
};
/// Truncated signed distances in a dense grid about all patches; of each patch, 8^3 cells near its surface.
[[nodiscard]] TsdfLoopCost tsdf_loop(const calib::LensValues& lens, const std::vector<PlacedPatch>& patches,
                                     double voxel_mm, double truncation_mm, int repeats);

/// OpenCV's HashTSDF on the same depth maps; nullopt where OpenCV was built without it. A patch.
[[nodiscard]] std::optional<double> hash_tsdf_ms(const calib::LensValues& lens, const std::vector<PlacedPatch>& patches,
                                                 double voxel_mm, double truncation_mm, int repeats);

}  // namespace enamel::bench
