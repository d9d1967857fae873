// Captured fringe sets of other people: numbered grey images, N-step phase, Gray code, an OpenCV calibration file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calib/model/rig.hpp"
#include "pipeline/types/map.hpp"
#include "tests/unit/decode/folder_burst.hpp"

namespace enamel::test {

struct FringeImages {
  int width = 0, height = 0;
  std::vector<std::vector<std::uint8_t>> images;
};

/// folder/NAME.png for every name. Errors: kFileNotFound, kImageInvalid (not 8-bit grey, or of another size).
[[nodiscard]] Result<FringeImages> load_fringe_images(const std::string& folder, const std::vector<std::string>& names);

/// "PREFIX00" … with two digits.
[[nodiscard]] std::vector<std::string> numbered(const std::string& prefix, int first, int count, int step = 1);

/// Images first, first + step, first + 2 step, first + 3 step as the frames of one burst.
[[nodiscard]] Result<FrameSet> burst_of(const FringeImages& set, std::size_t first, std::size_t step);

/// Least-squares solution of I_k = A + B cos(phi + 2 pi k/n) over images 0 … n-1.
struct StepSolution {
  Map<float> phase_rad, amplitude_dn, mean_dn;
};
[[nodiscard]] StepSolution solve_steps(const FringeImages& set, std::size_t n);

/// Binary number of the Gray code in images first … first+bits-1, most significant first; 1 where above `threshold_dn`.
[[nodiscard]] Map<std::int32_t> decode_gray(const FringeImages& set, std::size_t first, std::size_t bits,
                                            const Map<float>& threshold_dn);

/// Calibration file with M1 D1 (camera), M4 D4 (projector), Rlp Tlp (camera to projector, mm). Errors: kFileNotFound,
/// kRigInvalid (a matrix is missing or has another size).
struct ProjectorFacts {
  int width = 0, height = 0;
  double period_px = 0;
};
[[nodiscard]] Result<calib::Rig> load_camera_projector(const std::string& path, int width, int height,
                                                       const ProjectorFacts& projector);

}  // namespace enamel::test
