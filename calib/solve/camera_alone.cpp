#include "calib/solve/camera_alone.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calib/io/calib_folder.hpp"
#include "calib/model/lens.hpp"
#include "calib/solve/median.hpp"
#include "calib/solve/sanity.hpp"
#include "calib/target/chessboard.hpp"

namespace enamel::calib {
namespace {

using Eigen::Vector2d;

constexpr double kBadPictureRatio = 3;  // of a picture's rms to the median picture's

std::vector<double> rms_by_pose(const std::vector<PlaneView>& views, const LensStart& s) {
  std::vector<double> out;
  for (std::size_t j = 0; j < views.size(); ++j) {
    double squares = 0;
    for (std::size_t i = 0; i < views[j].image_px.size(); ++i) {
      const Vec3d p = s.T_lens_target[j] * Vec3d(views[j].target_mm[i].x(), views[j].target_mm[i].y(), 0);
      const PlanePoint q = project(s.lens, {p.x() / p.z(), p.y() / p.z()});
      squares += (views[j].image_px[i] - Vector2d(q.x, q.y)).squaredNorm();
    }
    out.push_back(std::sqrt(squares / static_cast<double>(views[j].image_px.size())));
  }
  return out;
}

Result<std::vector<PlaneView>> find_boards(const std::vector<std::pair<std::string, std::string>>& pictures,
                                           const TargetDesign& board, LensValues& design,
                                           std::vector<PoseNote>& rejected) {
  std::vector<PlaneView> views;
  for (const auto& [name, path] : pictures) {
    ENAMEL_TRY_ASSIGN(const Map<float> image, load_grey(path));
    if (design.width == 0) {
      design.width = image.width();
      design.height = image.height();
    }
    if (image.width() != design.width || image.height() != design.height) {
      return fail(ErrorCode::kImageInvalid, fmt::format("{}: {} x {} px, the pictures before it {} x {}", path,
                                                        image.width(), image.height(), design.width, design.height));
    }
    const auto corners = find_chessboard(image, board);
    if (!corners) {
      rejected.push_back({name, corners.error().detail});
      continue;
    }
    PlaneView view;
    view.name = name;
    for (const BoardCorner& c : *corners) {
      view.target_mm.emplace_back(board.place(c.index).head<2>());
      view.image_px.push_back(c.image_px);
    }
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace

Result<CameraSolution> solve_camera(const std::vector<std::pair<std::string, std::string>>& pictures,
                                    const TargetDesign& board) {
  CameraSolution out;
  LensValues design;
  ENAMEL_TRY_ASSIGN(std::vector<PlaneView> views, find_boards(pictures, board, design, out.rejected));
  if (views.empty() && !out.rejected.empty())
    return fail(ErrorCode::kTargetNotFound, out.rejected[0].pose + ": " + out.rejected[0].reason);
  design.cx = 0.5 * (design.width - 1);
  design.cy = 0.5 * (design.height - 1);
  design.fx = design.fy = design.width;
  for (;;) {
    if (views.size() < kMinPoses) {
      return fail(ErrorCode::kCalibrationPoses,
                  fmt::format("{} usable pictures, at least {} are needed", views.size(), kMinPoses));
    }
    ENAMEL_TRY_ASSIGN(out.start, best_start(views, design));
    ENAMEL_TRY(check_tilts(out.start.T_lens_target));
    out.rms_px = rms_by_pose(views, out.start);
    const auto worst = std::max_element(out.rms_px.begin(), out.rms_px.end());
    const double usual = median(out.rms_px);
    if (*worst <= kBadPictureRatio * usual) break;
    const auto at = views.begin() + (worst - out.rms_px.begin());
    out.rejected.push_back(
        {at->name, fmt::format("its corners fit with {:.2f} px rms, the median picture's with {:.2f}: "
                               "moved, bent, or counted from its other end",
                               *worst, usual)});
    views.erase(at);
  }
  for (const PlaneView& view : views) out.poses.push_back(view.name);
  return out;
}

}  // namespace enamel::calib
