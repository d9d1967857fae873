// What stands where other bursts looked through is not there: a region of a wrong fringe order, a far side that aliases
// into the range, a tongue that was in the way for a while. After the scan every burst can be asked by all keyframes.
// What keyframes of the same moments saw speaks for a point no more than one: a tongue at rest is seen by all of them.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "pipeline/register/map/map_burst.hpp"
#include "pipeline/register/map/map_edge.hpp"
#include "pipeline/types/patch.hpp"
#include "protocol/base/recent.hpp"

namespace enamel::pipeline {

struct FreeSpaceConfig {
  int block_px = 8;          ///< judged together, at one of its pixels: 0.3 mm on the object
  double through_mm = 0.3;   ///< chosen: so far before what a keyframe saw, ten times what poses and depths are off by
  double same_mm = 0.12;     ///< chosen: nearer to what a keyframe saw than this: seen by it too
  int min_through = 2;       ///< keyframes that looked through, and …
  double moment_s = 1.0;     ///< chosen: keyframes so near in time see the same passing body: together they count once
  int rim_blocks = 2;        ///< around what goes: what no other moment saw goes too
  double piece_jump_mm = 1;  ///< chosen: surface hangs together below it; fringe orders lie three times as far apart
  double reach_mm = 9;       ///< as MapConfig: of keyframes asked, at the points looked at
  double apart_mm = 2;  ///< between keyframes of a moment that are asked: those that looked the same way say the same …
  double apart_deg = 3;        ///< … unless they are turned by more
  std::size_t asked = 40;      ///< most, nearest first
  double whole_share = 0.5;    ///< chosen: of a piece of surface that hangs together; beyond, all of it goes
  double doubted_share = 0.1;  ///< chosen: of a piece that no other moment saw much of; beyond, all of it goes
};

/// Keyframes of a map, by number.
using MapNodes = Recent<MapNode>;

/// Immutable, thread-safe.
class FreeSpace {
 public:
  /// seen_from: when and from where each node was.
  FreeSpace(std::shared_ptr<const MapNodes> nodes, std::vector<MapBurst> seen_from, const ViewCamera& camera,
            double work_distance_mm, const FreeSpaceConfig& config);

  /// Takes out of the patch what more keyframes looked through than saw. Returns the number of pixels.
  std::size_t withdraw(const MapBurst& burst, SurfacePatch& patch) const;

 private:
  struct Asked {
    std::size_t k;
    std::shared_ptr<const MapNode> node;
    bool same_moment;
  };
  /// What keyframes say of a point.
  struct Votes {
    int through = 0, seen_then = 0, seen_again = 0;  ///< … in the burst's own moment, at other times
    [[nodiscard]] int in_favour() const { return seen_again + (seen_then > 0 ? 1 : 0); }
  };
  struct Cell;
  enum class Verdict : signed char { kNothing = 0, kSeen, kThrough };
  [[nodiscard]] std::vector<Asked> keyframes_near(const MapBurst& burst) const;
  [[nodiscard]] bool same_moment(const MapBurst& a, const MapBurst& b) const;
  [[nodiscard]] Verdict ask(const Asked& keyframe, const Vec3f& p_model) const;
  [[nodiscard]] Votes votes_on(const std::vector<Asked>& asked, const Vec3f& p_model) const;
  void judge(Map<Cell>& cells) const;
  void clear_pieces(Map<Cell>& cells) const;
  void clear_rim(Map<Cell>& cells) const;

  std::shared_ptr<const MapNodes> nodes_;
  std::vector<MapBurst> seen_from_;
  std::vector<Eigen::Matrix3f> R_cam_model_;
  std::vector<Vec3f> t_cam_model_;
  ViewCamera camera_;
  Vec3d work_;
  FreeSpaceConfig config_;
};

}  // namespace enamel::pipeline
