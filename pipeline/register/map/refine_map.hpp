// After a scan: all keyframes laid on all their neighbours, of every pass, and the poses that agree best with that.
// Tracking lays each burst on what the bursts before it left; its errors add up along the arch. Pairs that share half a
// picture span eight times as far as two bursts that follow each other, and passes over the same teeth tie each other.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "calib/model/rig.hpp"
#include "pipeline/register/icp/icp.hpp"
#include "pipeline/register/map/artefact_tie.hpp"
#include "pipeline/register/map/bow_find.hpp"
#include "pipeline/register/map/edge_memo.hpp"
#include "pipeline/register/map/free_space.hpp"
#include "pipeline/register/map/map_burst.hpp"
#include "pipeline/register/map/map_edge.hpp"
#include "pipeline/register/map/pose_graph.hpp"
#include "pipeline/register/map/stations.hpp"
#include "pipeline/types/patch.hpp"
#include "pipeline/types/texture_picture.hpp"
#include "protocol/base/time.hpp"

namespace enamel::pipeline {

struct MapConfig {
  bool refine = true;        ///< false: the poses stay as they were tracked
  double spacing_mm = 1;     ///< of keyframes along the way, at the point looked at …
  double spacing_deg = 1.5;  ///< … or by turns
  int crowd = 2;             ///< no more keyframes where so many look at the same place from the same side already
  double reach_mm = 9;       ///< derived: half a picture's width; farther apart two keyframes share too little
  double reach_deg = 65;     ///< derived: sides that see the same cusps; less than the right angle that sees none
  std::size_t after = 5;     ///< edges of a keyframe to those that followed it …
  std::size_t others = 10;   ///< … and to others near it, nearest first
  int sample_stride_px = 4;  ///< derived: 5 000 to 19 000 samples; an edge's error is not that of their number
  int view_stride_px = 2;    ///< derived: 56 um; the nearest pixel is off a bent surface by 0.4 um at R = 1 mm at most.
                             ///< Measured: with 84 um whole arches come out 3 to 4 um worse
  std::size_t nodes_kept = 320;  ///< chosen: keyframes that are in memory at a time, 2.5 MB each; an arch has 260
  double max_gap_s = 0.5;        ///< as TrackerConfig: across it two keyframes do not follow each other
  double least_way_mm = 15;      ///< chosen: shorter scans are told no station distances
  EdgeConfig edge;
  GraphConfig graph;
  FreeSpaceConfig free_space;
  BowConfig bow;
  ArtefactConfig artefact;
  std::optional<KnownArtefact> known;  ///< lies in the field of view; fault_of() it is empty
};

struct MapInput {
  std::vector<MapBurst> bursts;                   ///< in order of burst
  std::function<SurfacePatch(std::size_t)> load;  ///< patch of a burst, always the same; from several threads at once,
                                                  ///< and until RefinedMap::free_space is gone
  /// Of a burst whose motion shape did not determine, else null; as `load`.
  std::function<std::shared_ptr<const TexturePicture>(std::size_t)> texture = [](std::size_t) { return nullptr; };
  /// Calls work(n) for each n below count, once, on as many threads as it likes: they never change the result.
  std::function<void(std::size_t count, const std::function<void(std::size_t)>& work)> for_each =
      [](std::size_t count, const std::function<void(std::size_t)>& work) {
        for (std::size_t n = 0; n < count; ++n) work(n);
      };
  std::function<void(double)> progress = [](double) {};  ///< share done, from the calling thread
  EdgeMemo* memo = nullptr;  ///< what was measured of these bursts before; takes what is measured now
};

struct RefinedMap {
  std::vector<Pose> poses;  ///< of all bursts
  std::size_t keyframes = 0, edges = 0, loops = 0;
  std::size_t at_hand = 0;  ///< pairs, either way round, that had been measured before
  int switched_off = 0;
  double sigma0 = 0;
  double largest_move_mm = 0;                   ///< at the point looked at
  Stations stations;                            ///< empty where nothing was refined or the way is short
  std::optional<BowFacts> bow;                  ///< of the rig itself; where there are edges
  std::optional<ArtefactFacts> artefact;        ///< where one is known
  std::shared_ptr<const FreeSpace> free_space;  ///< of the keyframes where they are now; null where nothing was refined
};

/// Deterministic: a function of bursts and patches alone.
[[nodiscard]] RefinedMap refine_map(const MapInput& input, const calib::Rig& rig, const IcpConfig& icp,
                                    const MapConfig& config);

}  // namespace enamel::pipeline
