#include "host/app/calibrate/set.hpp"

#include <algorithm>

#include "calib/io/rig_writer.hpp"
#include "protocol/base/log.hpp"
#include "protocol/base/progress.hpp"

namespace enamel::app {
namespace {

constexpr calib::DepthRange kFallbackRange{40, 56};  // of the reference design, for rigs that state none

}  // namespace

calib::DepthRange range_of(const calib::Rig& rig) {
  if (!rig.depth_range) {
    log::warn("calibrate", "rig.json states no depth_range_mm: judged over {} to {} mm", kFallbackRange.near_mm,
              kFallbackRange.far_mm);
  }
  return rig.depth_range.value_or(kFallbackRange);
}

Result<calib::MeasuredFolder> measure(const calib::CalibFolder& folder, const Clock& clock) {
  Progress progress(clock, "measuring poses", folder.poses.size());
  return calib::measure_folder(folder, [&] { progress.advance(); });
}

Result<std::vector<calib::PoseView>> take_held_out(const std::vector<std::string>& names,
                                                   calib::MeasuredFolder& measured) {
  std::vector<calib::PoseView> held;
  for (const std::string& name : names) {
    const auto at = std::find_if(measured.views.begin(), measured.views.end(),
                                 [&](const calib::PoseView& v) { return v.name == name; });
    if (at == measured.views.end())
      return fail(ErrorCode::kUsage, "--hold-out " + name + ": no usable pose of that name");
    held.push_back(std::move(*at));
    measured.views.erase(at);
  }
  return held;
}

std::vector<calib::PlaneCheck> check_planes(const calib::CalibFolder& folder, const std::vector<calib::PoseView>& views,
                                            const calib::RigState& rig, const calib::Ripple& ripple) {
  std::vector<calib::PlaneCheck> planes;
  if (folder.target.type != calib::TargetType::kCircleGrid) return planes;
  for (const calib::PoseView& view : views) {
    auto plane = calib::check_plane(view, folder.target, rig, ripple);
    if (plane) {
      planes.push_back(std::move(*plane));
    } else {
      log::warn("calibrate", "{}", plane.error().detail);
    }
  }
  return planes;
}

Result<calib::Rig> load_intact(const std::string& path) {
  ENAMEL_TRY_ASSIGN(calib::Rig rig, calib::load_rig(path));
  if (!calib::is_rig_intact(rig.text))
    return fail(ErrorCode::kRigInvalid, path + ": its sha256 is not that of its content; it was changed after solving");
  return rig;
}

}  // namespace enamel::app
