#include "host/session/final_map.hpp"

#include <chrono>
#include <cmath>
#include <functional>
#include <utility>

#include "host/session/read_ahead.hpp"
#include "pipeline/flow/parallel.hpp"
#include "protocol/base/log.hpp"

namespace enamel::host {
namespace {

constexpr double kPosesShare = 0.6;  // of the time that it takes; the rest fuses

std::vector<Vec3f> one_a_square(const SurfacePatch& patch) {
  std::vector<Vec3f> out;
  for (int v = kPassedStepPx / 2; v < patch.points.height(); v += kPassedStepPx)
    for (int u = kPassedStepPx / 2; u < patch.points.width(); u += kPassedStepPx) out.push_back(patch.points(u, v));
  return out;
}

/// Patches in order without what other bursts looked through, and what became of them.
class CleanedPatches {
 public:
  CleanedPatches(const std::vector<pipeline::MapBurst>& bursts, const std::function<SurfacePatch(std::size_t)>& load,
                 std::shared_ptr<const pipeline::FreeSpace> free_space)
      : bursts_(bursts),
        load_(load),
        free_space_(std::move(free_space)),
        cleaned_(bursts.size(), [this](std::size_t n) { return clean(n); }) {}
  SurfacePatch operator()(std::size_t n) {
    Cleaned cleaned = cleaned_.next();
    withdrawn_px_ += cleaned.withdrawn_px;
    measured_px_ += cleaned.patch.valid_px + cleaned.withdrawn_px;
    for (const Vec3f& p : cleaned.withdrawn) {
      const Vec3d p_model = bursts_[n].T_model_cam * p.cast<double>();
      passed_.push_back({static_cast<std::uint32_t>(n), p_model.cast<float>()});
    }
    return std::move(cleaned.patch);
  }
  [[nodiscard]] std::uint64_t withdrawn_px() const noexcept { return withdrawn_px_; }
  [[nodiscard]] std::uint64_t measured_px() const noexcept { return measured_px_; }
  [[nodiscard]] std::vector<PassedPoint> take_passed() { return std::move(passed_); }

 private:
  struct Cleaned {
    SurfacePatch patch;
    std::size_t withdrawn_px;
    std::vector<Vec3f> withdrawn;  ///< camera frame, one a square
  };
  [[nodiscard]] Cleaned clean(std::size_t n) const {
    Cleaned out{load_(n), 0, {}};
    if (!free_space_) return out;
    const std::vector<Vec3f> before = one_a_square(out.patch);
    out.withdrawn_px = free_space_->withdraw(bursts_[n], out.patch);
    if (out.withdrawn_px == 0) return out;
    const std::vector<Vec3f> after = one_a_square(out.patch);
    for (std::size_t i = 0; i < before.size(); ++i)
      if (std::isfinite(before[i].z()) && !std::isfinite(after[i].z())) out.withdrawn.push_back(before[i]);
    return out;
  }
  const std::vector<pipeline::MapBurst>& bursts_;
  const std::function<SurfacePatch(std::size_t)>& load_;
  std::shared_ptr<const pipeline::FreeSpace> free_space_;
  std::uint64_t withdrawn_px_ = 0, measured_px_ = 0;
  std::vector<PassedPoint> passed_;
  ReadAhead<Cleaned> cleaned_;
};

double seconds_since(HostTime start, const Clock& clock) {
  return std::chrono::duration<double>(clock.now() - start).count();
}

}  // namespace

SurfacePatch final_patch(const Refined& kept, std::size_t n, const calib::Rig& rig, stage::FuseStage& fuse) {
  SurfacePatch patch = fuse.segments().patch_of(kept.history[n], pipeline::Texture::kDropped);
  if (!kept.bow_taken_out.isZero(0)) pipeline::BowField(rig).take_out(kept.bow_taken_out, patch);
  return patch;
}

Refined refine_model(const FinalMapInput& input, std::vector<MeasuredBurst>& placed, stage::FuseStage& fuse,
                     const Clock& clock) {
  const HostTime start = clock.now();
  Refined out;
  out.history = fuse.segments().take_history();
  std::vector<pipeline::KeptBurst>& history = out.history;
  MapFacts& facts = out.facts;
  if (history.size() != placed.size()) history.clear();
  if (history.empty()) return out;
  pipeline::MapInput map;
  for (const MeasuredBurst& burst : placed) map.bursts.push_back({burst.pose.t_mid, burst.pose.T_model_cam, burst.id});
  map.load = [&](std::size_t n) { return fuse.segments().patch_of(history[n], pipeline::Texture::kDropped); };
  map.texture = [&](std::size_t n) { return history[n].texture; };
  map.for_each = [&](std::size_t count, const std::function<void(std::size_t)>& work) {
    flow::for_each_index(count, input.threads, work);
  };
  map.progress = [&](double share) { input.progress(kPosesShare * share); };
  map.memo = input.memo;
  if (map.memo != nullptr) map.memo->measured_with(fuse.segments().soft_below());
  log::info("map", "refining the poses of {} bursts", history.size());
  pipeline::IcpConfig icp = input.config.track.icp;
  icp.samples.soft_below = fuse.segments().soft_below();
  const auto refined = pipeline::refine_map(map, input.rig, icp, input.config.map);
  if (fuse.segments().stored().lost > 0) {
    log::error("map", "bursts are missing; the model stays as it was scanned");
    history.clear();
    return out;
  }
  facts.refine_s = seconds_since(start, clock);
  facts.map = refined;
  facts.map.poses = {};
  facts.map.free_space = nullptr;
  if (refined.bow) out.bow_taken_out = refined.bow->taken_out;
  for (std::size_t n = 0; n < placed.size(); ++n) {
    placed[n].pose.T_model_cam = refined.poses[n];
    history[n].T_segment_cam = refined.poses[n];
    map.bursts[n].T_model_cam = refined.poses[n];
  }
  const pipeline::PatchStore::Figures kept = fuse.segments().stored();
  log::info("map", "fusing {} bursts anew; {} MB of them were kept in memory, {} MB in a file", history.size(),
            kept.memory_bytes >> 20U, kept.file_bytes >> 20U);
  const std::function<SurfacePatch(std::size_t)> load = [&](std::size_t n) {
    return final_patch(out, n, input.rig, fuse);
  };
  CleanedPatches ahead(map.bursts, load, refined.free_space);
  const auto bursts = static_cast<double>(history.size());
  fuse.rebuild(history, [&](std::size_t n) {
    input.progress(kPosesShare + (1 - kPosesShare) * static_cast<double>(n) / bursts);
    return ahead(n);
  });
  facts.seen_through_px = ahead.withdrawn_px();
  facts.measured_px = ahead.measured_px();
  facts.seconds = seconds_since(start, clock);
  out.passed = ahead.take_passed();
  return out;
}

}  // namespace enamel::host
