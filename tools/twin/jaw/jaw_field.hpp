// Teeth, gum and palate or floor of the mouth as one implicit surface in jaw coordinates (see path/arch.hpp).
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "tools/twin/jaw/dentition.hpp"

namespace enamel::twin {

/// Arc length s and signed offset n (> 0 outwards) of points about the arch, from a table over the plane.
class ArchCoordinates {
 public:
  explicit ArchCoordinates(const Arch& arch);
  struct At {
    double s, n;
  };
  [[nodiscard]] At at(double x, double y) const;

 private:
  double x0_ = 0, y0_ = 0;
  int nx_ = 0, ny_ = 0;
  std::vector<float> s_, n_;
};

class JawField {
 public:
  enum class Inside : std::uint8_t {
    kRim,    ///< the flank beside the teeth; further in the surface is not to be looked at
    kVault,  ///< the palate up to its seam in the middle, where the rugae end
  };
  JawField(Dentition dentition, JawSide side, std::uint64_t seed, Inside inside = Inside::kRim);

  struct Sample {
    double value = 0;   ///< < 0 inside; slope about 1 near the surface, never above kLipschitz
    double enamel = 0;  ///< 1 on teeth, 0 on gum, blended over 0.1 mm
    double groove = 0;  ///< 1 in fissures
  };
  static constexpr double kLipschitz = 2.0;
  [[nodiscard]] Sample sample(const Eigen::Vector3d& p) const;
  [[nodiscard]] double value(const Eigen::Vector3d& p) const { return sample(p).value; }

  [[nodiscard]] const Dentition& dentition() const { return dentition_; }
  [[nodiscard]] const ArchCoordinates& coordinates() const { return coordinates_; }

 private:
  [[nodiscard]] double ridge(const ArchCoordinates::At& a, const Eigen::Vector3d& p) const;
  [[nodiscard]] double collar(const PlacedTooth& t, const Eigen::Vector3d& q, double side) const;

  Dentition dentition_;
  JawSide side_;
  std::uint64_t seed_;
  Inside inside_;
  Arch arch_;
  ArchCoordinates coordinates_;
};

}  // namespace enamel::twin
