// Plaster molars on the table of a desktop mount, seen from two stops: patches with the decoder's noise and normals at
// poses that are known exactly. Needs the twin.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "calib/model/rig.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::test {

enum class Molars : std::uint8_t {
  kCusped,  ///< as the jaw's seed makes them
  kSmooth,  ///< worn flat: low domes without fissures or grooves, which slide about their own axes
};

/// Two stops 15 degrees of the table apart. Poses take camera to jaw coordinates.
struct MolarPair {
  int tooth = 6;  ///< that the table has brought before the head at the first stop
  double swing_deg = 0;
  SurfacePatch patch, reference;
  Pose T_jaw_patch = Pose::Identity(), T_jaw_reference = Pose::Identity();
};

/// One pair a molar (6 and 7, right side of the lower jaw) and swing. Not thread-safe.
class MolarTable {
 public:
  /// scene: file of a desktop mount with a jaw on it. A scene or rig that cannot be read ends the program.
  MolarTable(const std::string& scene_file, Molars kind, std::uint64_t seed);
  ~MolarTable();
  MolarTable(const MolarTable&) = delete;
  MolarTable& operator=(const MolarTable&) = delete;

  [[nodiscard]] const calib::Rig& rig() const;
  [[nodiscard]] MolarPair pair(int tooth, double swing_deg, std::uint64_t noise_seed) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Moves `truth` by exactly so much about the point looked at, both directions uniform.
[[nodiscard]] Pose drawn_start(const Pose& truth, double shift_mm, double turn_deg, std::uint64_t seed);

struct PoseError {
  double shift_um = 0;  ///< of the point looked at, 48 mm before the camera
  double turn_deg = 0;
};
[[nodiscard]] PoseError pose_error(const Pose& found, const Pose& truth);

/// derived: noise alone moves an alignment by less than 1 um; 10 um and 0.05 degrees (9 um at the edge of the field)
/// are a tenth of the finest gate, 0.15 mm, so what lies within has found the truth and what has not lies far outside.
inline constexpr double kFoundShift_um = 10, kFoundTurn_deg = 0.05;
[[nodiscard]] inline bool found_truth(const PoseError& e) {
  return e.shift_um < kFoundShift_um && e.turn_deg < kFoundTurn_deg;
}

}  // namespace enamel::test
