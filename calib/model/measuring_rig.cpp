#include "calib/model/measuring_rig.hpp"

namespace enamel::calib {
namespace {

bool same_size(const LensValues& a, const LensValues& b) { return a.width == b.width && a.height == b.height; }

}  // namespace

Result<Rig> measuring_rig(const Rig& calibration, const Rig& device) {
  if (!calibration.serial.empty() && !device.serial.empty() && calibration.serial != device.serial) {
    return fail(ErrorCode::kRigForeign,
                "the calibration is of probe " + calibration.serial + ", the bursts are of probe " + device.serial);
  }
  if (!same_size(calibration.camera, device.camera) || !same_size(calibration.projector, device.projector))
    return fail(ErrorCode::kRigInvalid, "the calibration is of another image or projector size than the bursts");
  Rig rig = calibration;
  rig.patterns = device.patterns;
  rig.noise = device.noise;
  rig.crc32 = device.crc32;
  if (!rig.depth_range) rig.depth_range = device.depth_range;
  return rig;
}

}  // namespace enamel::calib
