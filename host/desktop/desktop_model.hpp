// What a desktop scan has measured so far, stop by stop, and the model made of it in the end.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/mount.hpp"
#include "calib/model/rig.hpp"
#include "host/desktop/desktop_config.hpp"
#include "host/desktop/stop_bursts.hpp"
#include "host/session/scan_pipeline.hpp"
#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/model/mesh/incremental_mesher.hpp"
#include "pipeline/model/segments/packed_patch.hpp"
#include "pipeline/register/stops/lay_stops.hpp"
#include "pipeline/register/stops/table_relief.hpp"
#include "pipeline/stages/items.hpp"

namespace enamel::host {

/// A burst's way, whatever became of it.
struct StopBurst {
  BurstId id;
  DeviceTime t_mid{};
  stage::Digests digests;
  std::string rejected;  ///< empty: it is part of its stop's patch
};

struct MeasuredStop {
  std::vector<StopBurst> bursts;
  calib::AxisAngles angles;
  bool saw_model = false;       ///< enough to be laid on others; else what follows is empty
  pipeline::Stop stop;          ///< until the scan is laid
  pipeline::PackedPatch patch;  ///< the mean of its bursts, table taken out
  std::size_t seen_px = 0;      ///< of that patch …
  std::size_t table_px = 0;     ///< … and taken out
  double distance_mm = std::numeric_limits<double>::quiet_NaN();  ///< mean depth of what is kept; NaN: nothing
};

/// Results depend on the sequence of stops alone, never on threads. One owner.
class DesktopModel {
 public:
  /// Errors: of BurstDecoder::make; kMountForeign when mount and rig name different scanners.
  [[nodiscard]] static Result<DesktopModel> make(const calib::Rig& rig, const calib::Mount& mount,
                                                 const DesktopConfig& config, std::size_t threads);

  /// Of the empty table, before the first stop that is kept: its surface is taken out of all that follow. Returns what
  /// became of its bursts.
  std::vector<StopBurst> add_empty(const StopBursts& stop);
  /// Decodes and keeps a stop, and adds it to the growing model where the axes put it.
  const MeasuredStop& add(const StopBursts& stop);

  [[nodiscard]] const std::vector<MeasuredStop>& stops() const noexcept { return stops_; }
  /// What the stop saw, table taken out; empty when it saw no model. Before finish().
  [[nodiscard]] SurfacePatch patch_of(std::size_t k) const;
  /// What table or model did by themselves so far, stops counted as they were taken.
  [[nodiscard]] std::vector<pipeline::Slip> slips() const;
  [[nodiscard]] const calib::Rig& rig() const noexcept { return rig_; }
  [[nodiscard]] const calib::Mount& mount() const noexcept { return mount_; }
  /// For a window: the growing surface, as the stops were laid so far.
  [[nodiscard]] ModelSnapshot snapshot();
  [[nodiscard]] std::shared_ptr<const Map<std::uint8_t>> live_image() const noexcept { return live_; }

  /// Lays all stops on each other and fuses them anew: fills mesh, poses, trace and counts of `scan`. Once. Error:
  /// kModelNotSeen when no stop saw anything.
  [[nodiscard]] Result<pipeline::LaidStops> finish(ScanResult& scan);

 private:
  /// What depends on the optics as they were at the first burst; at a fixed place, for parts of it refer to others.
  struct Parts {
    Parts(const calib::Rig& rig, const calib::Mount& mount, const DesktopConfig& config, pipeline::BurstDecoder made);
    calib::Rig optics;
    pipeline::BurstDecoder decoder;
    pipeline::Unpacker unpack;
    pipeline::IcpConfig icp;
    pipeline::EdgeConfig edge;
    pipeline::PatchViewer viewer;
    pipeline::StopFollower follower;  ///< of the stops that saw the model
    pipeline::TsdfModel growing;
  };

  DesktopModel(const calib::Rig& rig, const calib::Mount& mount, const DesktopConfig& config, std::size_t threads);
  /// Optics at the first burst's temperature, as ScanPipeline has them.
  void open(const StopBursts& first);
  [[nodiscard]] SurfacePatch measure(const StopBursts& stop, std::vector<StopBurst>& bursts);
  /// stops_ of each that the follower has.
  [[nodiscard]] std::vector<std::size_t> followed() const;
  [[nodiscard]] pipeline::FuseConfig fuse_config() const;
  void fuse(const std::vector<std::size_t>& of, const pipeline::LaidStops& laid, ScanResult& scan);
  void conclude(ScanResult& scan) const;

  calib::Rig rig_;
  calib::Mount mount_;
  DesktopConfig config_;
  std::size_t threads_;
  std::unique_ptr<Parts> parts_;
  pipeline::TableRelief relief_;
  pipeline::WaveKnowledge wave_;
  std::vector<MeasuredStop> stops_;
  pipeline::IncrementalMesher mesher_;
  std::shared_ptr<const Map<std::uint8_t>> live_;
  bool is_open_ = false;
  bool is_averaged_ = false;  ///< some stop has more than one burst
};

}  // namespace enamel::host
