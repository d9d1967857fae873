// A depth map beside the plain decoder's of the same burst: where that one is hardly ever wrong, a better one must
// place about as much, with no more of it wrong.
#pragma once

#include <cstddef>
#include <cstdint>

#include "calib/model/rig.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::test {

struct DepthTruth {
  Map<float> depth_mm;     ///< camera z; NaN where there is no surface
  Map<std::uint8_t> lit;   ///< not 0 where the projector reaches the surface
  Map<std::uint8_t> edge;  ///< not 0 beside a jump of depth
};

/// Marks both sides of every pair of neighbours whose depths differ by more than this, or of which one has none.
inline constexpr float kDepthEdge_mm = 0.25F;
[[nodiscard]] Map<std::uint8_t> depth_edges(const Map<float>& depth_mm);

/// What became of the pixels whose true depth lies within the rig's range.
struct Floor {
  std::size_t lit = 0, covered = 0;   ///< lit ones; of these placed ones
  std::size_t placed = 0, wrong = 0;  ///< lit or not; of these off by more than half a fringe

  [[nodiscard]] double coverage() const { return share(covered, lit); }
  [[nodiscard]] double wrong_share() const { return share(wrong, placed); }

 private:
  static double share(std::size_t part, std::size_t whole) {
    return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
  }
};

/// Needs rig.depth_range and maps of the camera's size.
[[nodiscard]] Floor floor_of(const calib::Rig& rig, const DepthTruth& truth, const Map<float>& depth_mm);

struct BesidePlain {
  static constexpr double kFloorWrong = 0.001;  ///< a plain map with a larger share wrong is no floor
  static constexpr double kLess = 0.01;         ///< of coverage that may be missing
  static constexpr double kLessAtEdges = 0.03;  ///< the same where edges are in view: one who knows them keeps away

  Floor product, plain;
  bool edges = false;  ///< a lit pixel lies beside a jump of depth

  [[nodiscard]] bool is_floor() const { return plain.covered > 0 && plain.wrong_share() <= kFloorWrong; }
  [[nodiscard]] bool covers_as_much() const {
    return product.coverage() >= plain.coverage() - (edges ? kLessAtEdges : kLess);
  }
  [[nodiscard]] bool no_more_wrong() const { return product.wrong_share() <= plain.wrong_share(); }
  /// True as well where the plain map is no floor.
  [[nodiscard]] bool holds() const { return !is_floor() || (covers_as_much() && no_more_wrong()); }
};

[[nodiscard]] BesidePlain beside_plain(const calib::Rig& rig, const DepthTruth& truth, const Map<float>& product_mm,
                                       const Map<float>& plain_mm);

}  // namespace enamel::test
