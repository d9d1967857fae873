// What can be wrong with a jaw or with how it is scanned, for scenes that a detector has to see. Lengths mm.
#pragma once

#include <cstdint>

#include "tools/twin/jaw/dentition.hpp"
#include "tools/twin/surface/tri_surface.hpp"

namespace enamel::twin {

/// Everything is off by default. Teeth are those of the right quadrant, 1 … 7.
struct FaultConfig {
  int tooth = 6;              ///< that it befalls
  double spot_mm = 0;         ///< radius of a spot on its biting side that returns no light
  double gap_mm = 0;          ///< the teeth behind it stand farther off by so much
  double web_um = 0;          ///< thickness of a web of saliva across that gap
  double move_um = 0;         ///< the tooth goes towards the cheek by so much …
  double move_at_s = 0;       ///< … at that time of the scan
  bool is_prepared = false;   ///< ground for a crown, with a shoulder all round
  double finish_edge_mm = 0;  ///< its outer edge, the finish line, is rounded over so wide a strip
  bool is_scan_body = false;  ///< an implant's scan body in its stead
  double body_error_um = 0;   ///< the scan body is so much thicker than it should be, in radius
};

/// The scan body as its maker states it: a cylinder with a flat towards the cheek. Origin and axis as of a tooth.
inline constexpr double kScanBodyRadiusMm = 2.2, kScanBodyHeightMm = 8.0, kScanBodyFlatMm = 1.5;

/// Prepares the tooth, or puts the scan body in its place.
void apply_fault(const FaultConfig& fault, Dentition& dentition);
/// The tooth after it has moved.
void move_tooth(const FaultConfig& fault, Dentition& dentition);
/// Blackens the spot, which lies on the biting side at a place by the seed.
void blacken_spot(const FaultConfig& fault, const Dentition& dentition, std::uint64_t seed, TriSurface& mesh);

/// Web across the gap behind the tooth: < 0 inside, slope 1. s, n, z: arch coordinates and height.
class Web {
 public:
  Web(const FaultConfig& fault, const Dentition& dentition);
  [[nodiscard]] double value(double s, double n, double z) const;

 private:
  double thickness_mm_, s_ = 0, half_ = 0, top_ = 0;
};

}  // namespace enamel::twin
