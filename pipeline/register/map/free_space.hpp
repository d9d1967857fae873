// What stands where other bursts looked through is not there: a region of a wrong fringe order, a far side that aliases
// into the range, a tongue that was in the way for a moment. After the scan every burst can be asked by all keyframes.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "pipeline/register/map/map_edge.hpp"
#include "pipeline/types/patch.hpp"
#include "protocol/base/recent.hpp"

namespace enamel::pipeline {

struct FreeSpaceConfig {
  int block_px = 8;          ///< judged together, at one of its pixels: 0.3 mm on the object
  double through_mm = 1.0;   ///< chosen: so far before what a keyframe saw; fringe orders lie three times as far apart
  double same_mm = 0.3;      ///< nearer to what a keyframe saw than this: seen by it too
  int min_through = 3;       ///< keyframes that looked through, and …
  double reach_mm = 9;       ///< as MapConfig: of keyframes asked, at the points looked at
  double apart_mm = 2;       ///< between keyframes that are asked: those that looked the same way say the same …
  double apart_deg = 3;      ///< … unless they are turned by more
  std::size_t asked = 40;    ///< most, nearest first
  double whole_share = 0.5;  ///< chosen: of a piece of surface that hangs together; beyond, all of it goes
};

/// Keyframes of a map, by number.
using MapNodes = Recent<MapNode>;

/// Immutable, thread-safe.
class FreeSpace {
 public:
  /// T_model_cam: of each node.
  FreeSpace(std::shared_ptr<const MapNodes> nodes, std::vector<Pose> T_model_cam, const ViewCamera& camera,
            double work_distance_mm, const FreeSpaceConfig& config);

  /// Takes out of the patch what more keyframes looked through than saw. Returns the number of pixels.
  std::size_t withdraw(const Pose& T_model_cam, SurfacePatch& patch) const;

 private:
  struct Asked {
    std::size_t k;
    std::shared_ptr<const MapNode> node;
  };
  enum class Verdict : signed char { kNothing = 0, kSeen, kThrough };
  [[nodiscard]] std::vector<Asked> keyframes_near(const Pose& T_model_cam) const;
  [[nodiscard]] Verdict ask(const Asked& keyframe, const Vec3f& p_model) const;
  [[nodiscard]] bool is_empty_space(const std::vector<Asked>& asked, const Vec3f& p_model) const;

  std::shared_ptr<const MapNodes> nodes_;
  std::vector<Pose> T_model_cam_;
  std::vector<Eigen::Matrix3f> R_cam_model_;
  std::vector<Vec3f> t_cam_model_;
  ViewCamera camera_;
  Vec3d work_;
  FreeSpaceConfig config_;
};

}  // namespace enamel::pipeline
