// The calibration folder of the exchange format: rig.json (design values), target.json, poses/NN/{white,black}.png and
// {v,h}_<cycles>_<k>.png.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/fringe/phase.hpp"
#include "calib/io/frame_correction.hpp"
#include "calib/model/rig.hpp"
#include "calib/target/pixel_noise.hpp"
#include "calib/target/target.hpp"
#include "protocol/base/result.hpp"

namespace enamel::calib {

struct CalibFolder {
  std::string path;
  Rig nominal;
  TargetDesign target;
  std::vector<std::string> poses;       ///< names of the folders under poses/, sorted
  std::vector<int> cycles_u, cycles_v;  ///< rising; of v_<cycles>_* and h_<cycles>_*
  std::optional<PixelNoise> noise;      ///< of one image; absent where neither rig.json nor step 0 tells
  FrameCorrection correction;           ///< step 0: load_pose applies it
  double saturation_dn = 255;           ///< full scale of the sensor
};

/// All images of one pose, DN.
struct PoseFrames {
  std::string name;
  Map<float> raw_white;  ///< white as the sensor gave it; empty where step 0 changed nothing
  Map<float> white, black;
  std::vector<FringeLevel> along_u, along_v;  ///< by rising cycles
};

/// What a set must hold: a rig needs fringes along both axes, a mount with a solved rig does without.
enum class FringeNeed : std::uint8_t { kBoth, kNone };

/// Errors: kFileNotFound, kFileRead, kRigInvalid, kTargetFile; kCalibrationFolder when there are no poses or no
/// fringes.
[[nodiscard]] Result<CalibFolder> open_calib_folder(const std::string& path, FringeNeed need = FringeNeed::kBoth);

/// Errors: kCalibrationFolder for a missing image, kImageInvalid for one of another size or kind; the detail names the
/// file.
[[nodiscard]] Result<PoseFrames> load_pose(const CalibFolder& folder, const std::string& pose);

/// A grey PNG of 8 or 16 bit as it stands. Errors: kCalibrationFolder, kImageInvalid.
[[nodiscard]] Result<Map<float>> load_grey(const std::string& path);

/// The same; kImageInvalid when it is of another size.
[[nodiscard]] Result<Map<float>> load_grey(const std::string& path, int width, int height);

}  // namespace enamel::calib
