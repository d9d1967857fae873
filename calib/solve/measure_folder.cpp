#include "calib/solve/measure_folder.hpp"

#include <optional>

namespace enamel::calib {

std::array<double, 2> finest_periods_px(const CalibFolder& folder) {
  return {static_cast<double>(folder.nominal.projector.width) / folder.cycles_u.back(),
          static_cast<double>(folder.nominal.projector.height) / folder.cycles_v.back()};
}

namespace {

void note_correction(const CalibFolder& folder, std::vector<std::string>& notes) {
  const FrameCorrection& c = folder.correction;
  if (c.dark_frames > 0) notes.push_back(std::to_string(c.dark_frames) + " dark frames subtracted");
  if (c.gain.size() > 0) notes.emplace_back("flat field divided");
  if (c.is_empty())
    notes.emplace_back("no dark frames and no flat field: pictures taken as they stand (step 0 skipped)");
  if (!folder.nominal.noise && c.noise) {
    notes.push_back("rig.json states no noise: photon transfer of dark frames and flat field says " +
                    std::to_string(c.noise->floor_dn2) + " DN² + " + std::to_string(c.noise->slope_dn) + " DN a DN");
  }
}

/// What is wrong with one pose: the table's text, except where that speaks of the set as a whole.
std::string reason_of(const Error& error) {
  if (error.code == ErrorCode::kCalibrationPoses) return error.detail;
  return std::string(describe(error.code).text) + ": " + error.detail;
}

}  // namespace

Result<MeasuredFolder> measure_folder(const CalibFolder& folder, const std::function<void()>& on_pose) {
  MeasuredFolder out;
  std::optional<PixelNoise> noise = folder.noise;
  std::optional<Error> first;
  std::optional<EdgeModel> edges;
  ENAMEL_TRY_ASSIGN(out.response, read_response(folder.path, folder.saturation_dn));
  if (out.response) ENAMEL_TRY(check_response(*out.response));
  if (!out.response)
    out.notes.emplace_back("no pictures of the projector's response: taken as linear (step 0 skipped)");
  note_correction(folder, out.notes);
  for (const std::string& pose : folder.poses) {
    const auto frames = load_pose(folder, pose);
    if (frames && !noise) {
      noise = estimate_noise(*frames);
      out.notes.push_back("rig.json states no noise: estimated from pose " + pose);
    }
    // The lens is the same in all poses: the first one with a target tells.
    if (frames && !edges) {
      if (const auto chosen = choose_edge_model(*frames, folder.target, *noise)) edges = *chosen;
    }
    auto view = !frames ? Result<PoseView>(tl::unexpected<Error>(frames.error()))
                        : measure_pose(*frames, folder.target, *noise, folder.saturation_dn,
                                       {folder.nominal.projector.width, folder.nominal.projector.height},
                                       edges.value_or(EdgeModel::kLensThenPixel));
    if (view) {
      out.views.push_back(std::move(*view));
    } else {
      out.rejected.push_back({pose, reason_of(view.error())});
      if (!first) first = view.error();
    }
    if (on_pose) on_pose();
  }
  if (out.views.empty() && first) return tl::unexpected<Error>(*first);
  out.noise = noise.value_or(PixelNoise{});
  if (folder.cycles_u.empty() || folder.cycles_v.empty()) return out;
  std::vector<std::vector<ProjectorSample>> discs;
  for (const PoseView& view : out.views)
    for (const DotView& dot : view.dots) discs.push_back(dot.samples);
  out.ripple = estimate_ripple(discs, finest_periods_px(folder));
  return out;
}

}  // namespace enamel::calib
