#include "host/desktop/desktop_model.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "pipeline/flow/parallel.hpp"
#include "pipeline/stages/decode_burst.hpp"
#include "pipeline/stages/digest.hpp"
#include "pipeline/stages/live_image.hpp"

namespace enamel::host {
namespace {

constexpr std::size_t kFewestSamples = 200;  // as IcpConfig::min_matches: fewer cannot be laid on anything
constexpr double kVisibleMove_mm = 0.005;    // a preview need not follow every micron

bool has_two_alike(const StopBursts& stop) {
  std::set<std::uint32_t> seen;
  return std::ranges::any_of(stop.bursts,
                             [&](const auto& burst) { return !seen.insert(burst->meta.front().exposure_us).second; });
}

}  // namespace

Result<DesktopModel> DesktopModel::make(const calib::Rig& rig, const calib::Mount& mount, const DesktopConfig& config,
                                        std::size_t threads) {
  if (!mount.serial.empty() && !rig.serial.empty() && mount.serial != rig.serial) {
    return fail(ErrorCode::kMountForeign, "mount.json is of " + mount.serial + ", the bursts of " + rig.serial);
  }
  ENAMEL_TRY_ASSIGN(auto decoder, pipeline::BurstDecoder::make(rig, config.pipeline.decode));
  DesktopModel out(rig, mount, config, threads);
  out.parts_ = std::make_unique<Parts>(rig, mount, config, std::move(decoder));
  return out;
}

DesktopModel::DesktopModel(const calib::Rig& rig, const calib::Mount& mount, const DesktopConfig& config,
                           std::size_t threads)
    : rig_(rig),
      mount_(mount),
      config_(config),
      threads_(std::max<std::size_t>(threads, 1)),
      relief_(mount, config.relief, config.above_mm),
      mesher_(config.pipeline.mesh) {}

DesktopModel::Parts::Parts(const calib::Rig& rig, const calib::Mount& mount, const DesktopConfig& config,
                           pipeline::BurstDecoder made)
    : optics(rig),
      decoder(std::move(made)),
      unpack(decoder.shared_rays(), decoder.config().normals),
      icp(config.pipeline.track.icp),
      edge(config.lay.edge),
      viewer(pipeline::stop_viewer(rig.camera, config.lay)),
      follower(mount, {optics.camera, icp, edge}, config.lay.slip),
      growing(rig, config.pipeline.fuse) {}

void DesktopModel::open(const StopBursts& first) {
  if (std::exchange(is_open_, true) || !rig_.temperature || first.bursts.empty()) return;
  const calib::Rig warm = calib::rig_at(rig_, first.bursts.front()->temp_centi_c / 100.0);
  // Optics that decode cold and not warm are as good as none: the calibrated ones stay.
  if (auto decoder = pipeline::BurstDecoder::make(warm, config_.pipeline.decode))
    parts_ = std::make_unique<Parts>(warm, mount_, config_, std::move(*decoder));
}

/// Bursts of one stop side by side. What they tell of the projector is learned in their order, so that it never
/// depends on which was decoded first.
SurfacePatch DesktopModel::measure(const StopBursts& stop, std::vector<StopBurst>& bursts) {
  open(stop);
  std::vector<stage::DecodedOrNot> decoded(stop.bursts.size());
  flow::for_each_index(stop.bursts.size(), threads_, [&](std::size_t n) {
    pipeline::DecodeWorkspace workspace;
    decoded[n] = stage::decode_burst(parts_->decoder, *stop.bursts[n], config_.calib_crc32, wave_, workspace);
  });
  std::vector<SurfacePatch> patches;
  std::map<std::uint32_t, int> exposed;
  int alike = 1;
  for (std::size_t n = 0; n < decoded.size(); ++n) {
    const proto::Burst& burst = *stop.bursts[n];
    bursts.push_back({burst.id(), proto::mid_burst(burst), {}, {}});
    if (!decoded[n].decoded) {
      bursts.back().rejected = decoded[n].rejected;
      continue;
    }
    bursts.back().digests = decoded[n].decoded->digests;
    if (decoded[n].decoded->wave_shown) pipeline::learn(*decoded[n].decoded->wave_shown, wave_);
    alike = std::max(alike, ++exposed[burst.meta.front().exposure_us]);
    patches.push_back(std::move(decoded[n].decoded->patch));
  }
  // Where one exposure sees nothing, no more bursts can agree than there are of another.
  pipeline::MeanConfig mean = config_.mean;
  mean.min_agreeing = std::min(mean.min_agreeing, alike);
  return pipeline::mean_patch(patches, parts_->decoder.rays(), parts_->decoder.config().normals, mean);
}

std::vector<StopBurst> DesktopModel::add_empty(const StopBursts& stop) {
  std::vector<StopBurst> bursts;
  const SurfacePatch patch = measure(stop, bursts);
  relief_.add(patch, pipeline::pose_by_axes(mount_, stop.angles));
  return bursts;
}

const MeasuredStop& DesktopModel::add(const StopBursts& stop) {
  MeasuredStop out;
  out.angles = stop.angles;
  SurfacePatch patch = measure(stop, out.bursts);
  is_averaged_ = is_averaged_ || has_two_alike(stop);
  if (!patch.texture_dn.empty()) live_ = std::make_shared<const Map<std::uint8_t>>(stage::live_image(patch.texture_dn));
  out.table_px = relief_.take_out(pipeline::pose_by_axes(mount_, stop.angles), patch);
  out.seen_px = patch.valid_px;
  pipeline::Stop seen = pipeline::make_stop(patch, stop.angles, parts_->viewer, parts_->icp, config_.lay);
  out.saw_model = seen.node.samples.size() >= kFewestSamples;
  if (out.saw_model) {
    out.distance_mm = seen.centre.z();
    out.patch = pipeline::pack(patch, pipeline::Texture::kDropped);
    parts_->growing.integrate(out.bursts.front().id, patch, parts_->follower.follow(std::move(seen)));
  } else {
    for (StopBurst& burst : out.bursts) {
      if (burst.rejected.empty()) burst.rejected = "no_model";
    }
  }
  stops_.push_back(std::move(out));
  return stops_.back();
}

SurfacePatch DesktopModel::patch_of(std::size_t k) const {
  const MeasuredStop& stop = stops_[k];
  return stop.saw_model && !stop.patch.runs.empty() ? parts_->unpack(stop.patch) : SurfacePatch{};
}

ModelSnapshot DesktopModel::snapshot() {
  mesher_.update(parts_->growing, parts_->growing.take_changed(kVisibleMove_mm));
  return mesher_.snapshot();
}

std::vector<std::size_t> DesktopModel::followed() const {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < stops_.size(); ++k) {
    if (stops_[k].saw_model) out.push_back(k);
  }
  return out;
}

std::vector<pipeline::Slip> DesktopModel::slips() const {
  std::vector<pipeline::Slip> out = parts_->follower.followed().slips;
  const std::vector<std::size_t> of = followed();
  for (pipeline::Slip& slip : out) slip.stop = of[slip.stop];
  return out;
}

/// What several bursts of a stop agree on has been seen more than once already.
pipeline::FuseConfig DesktopModel::fuse_config() const {
  pipeline::FuseConfig fuse = config_.pipeline.fuse;
  if (is_averaged_) fuse.min_bursts = 1;
  return fuse;
}

Result<pipeline::LaidStops> DesktopModel::finish(ScanResult& scan) {
  const std::vector<std::size_t> of = followed();
  if (of.empty()) {
    return fail(ErrorCode::kModelNotSeen, std::to_string(stops_.size()) + " stops, and none of them saw a model");
  }
  const auto for_each = [&](std::size_t count, const std::function<void(std::size_t)>& work) {
    flow::for_each_index(count, threads_, work);
  };
  pipeline::LaidStops laid =
      pipeline::lay_stops({parts_->follower, mount_, parts_->optics, parts_->icp, for_each}, config_.lay);
  for (std::size_t n = 0; n < of.size(); ++n) {
    const bool is_laid = laid.laid[n] != pipeline::Laid::kNot;
    for (StopBurst& burst : stops_[of[n]].bursts) {
      if (!burst.rejected.empty()) continue;
      if (!is_laid) burst.rejected = "not_laid";
      if (is_laid) scan.poses.push_back({burst.id, burst.t_mid, laid.T_model_cam[n]});
    }
  }
  laid.slips = slips();
  fuse(of, laid, scan);
  conclude(scan);
  return laid;
}

/// In the order of the stops; their patches are not needed afterwards.
void DesktopModel::fuse(const std::vector<std::size_t>& of, const pipeline::LaidStops& laid, ScanResult& scan) {
  pipeline::TsdfModel model(parts_->optics, fuse_config());
  for (std::size_t n = 0; n < of.size(); ++n) {
    MeasuredStop& stop = stops_[of[n]];
    if (laid.laid[n] != pipeline::Laid::kNot) {
      const pipeline::FuseStats stats =
          model.integrate(stop.bursts.front().id, parts_->unpack(stop.patch), laid.T_model_cam[n]);
      const std::uint64_t track = stage::Digest().add(laid.T_model_cam[n]).value();
      const std::uint64_t fused =
          stage::Digest().add(stats.surfels_used).add(stats.voxels_updated).add(stats.blocks_new).value();
      for (StopBurst& burst : stop.bursts) {
        if (!burst.rejected.empty()) continue;
        burst.digests.track = track;
        burst.digests.fuse = fused;
      }
    }
    stop.patch = {};
  }
  parts_->growing = std::move(model);
  mesher_ = pipeline::IncrementalMesher(config_.pipeline.mesh);
  mesher_.update(parts_->growing, parts_->growing.take_changed());
  scan.mesh = mesher_.extract();
}

void DesktopModel::conclude(ScanResult& scan) const {
  for (const MeasuredStop& stop : stops_) {
    for (const StopBurst& burst : stop.bursts) {
      const stage::Digests& d = burst.digests;
      const bool is_fused = burst.rejected.empty();
      scan.trace.add({burst.id.value, {d.input, d.decode, d.track, d.fuse}, is_fused ? "fused" : burst.rejected});
      ++scan.accepted;
      ++(is_fused ? scan.fused : scan.rejected[burst.rejected]);
    }
  }
}

}  // namespace enamel::host
