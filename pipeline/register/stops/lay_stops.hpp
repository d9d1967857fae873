// A desktop scan's stops, laid coarsely by the axes and finely by their surfaces: every two that overlap are an edge,
// the axes are a soft prior of every stop, the mount's lines are fitted anew to what comes out.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "calib/model/rig.hpp"
#include "pipeline/register/icp/patch_view.hpp"
#include "pipeline/register/stops/closing.hpp"
#include "pipeline/register/stops/mount_refit.hpp"
#include "pipeline/register/stops/slip.hpp"
#include "pipeline/register/stops/stop.hpp"

namespace enamel::pipeline {

struct LayConfig {
  double min_overlap = 0.2;      ///< of a pair, as EdgeConfig::min_overlap
  double overlap_gate_mm = 0.3;  ///< of its foretelling
  int rounds = 3;                ///< of graph and lines by turns; 1: the lines stay as calibrated
  int sample_stride_px = 2;      ///< of a stop's patch: few stops, so all that it has
  int view_stride_px = 2;        ///< as MapConfig
  StopSigma stop;
  MountSigma lines;
  SlipConfig slip;
  EdgeConfig edge;
  GraphConfig graph;
};

/// For all stops of a scan: it knows where the lens brings every pixel.
[[nodiscard]] PatchViewer stop_viewer(const calib::LensValues& lens, const LayConfig& config);

/// Makes a stop of its patch. Pure.
[[nodiscard]] Stop make_stop(const SurfacePatch& patch, const calib::AxisAngles& angles, const PatchViewer& viewer,
                             const IcpConfig& icp, const LayConfig& config);

struct LayInput {
  const StopFollower& taken;  ///< with the same mount
  const calib::Mount& mount;
  const calib::Rig& rig;
  const IcpConfig& icp;
  /// As MapInput::for_each.
  std::function<void(std::size_t count, const std::function<void(std::size_t)>& work)> for_each;
};

struct LaidStops {
  std::vector<Pose> by_axes;      ///< T_model_cam of every stop, slips allowed for …
  std::vector<Pose> T_model_cam;  ///< … and in the end
  std::vector<Laid> laid;
  std::vector<Slip> slips;
  std::vector<StopDeviation> corrections;  ///< of each stop beyond the mount as fitted
  calib::Mount mount;                      ///< as fitted
  std::size_t pairs = 0, edges = 0;        ///< overlapping, measured (each pair both ways)
  int switched_off = 0;
  double sigma0 = 0;
  double coarse_rms_mm = 0, fine_rms_mm = 0;  ///< of all edges: how far surfaces lie apart, by the axes and in the end
  std::vector<Circle> circles;
};

/// Deterministic: a function of stops, mount and configuration alone.
[[nodiscard]] LaidStops lay_stops(const LayInput& input, const LayConfig& config);

}  // namespace enamel::pipeline
