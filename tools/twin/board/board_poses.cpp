#include "tools/twin/board/board_poses.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tools/twin/degrees.hpp"
#include "tools/twin/optics/random.hpp"

namespace enamel::twin {
namespace {

constexpr double kMinTilt_deg = 15, kMaxTilt_deg = 35, kMaxRoll_deg = 8;
constexpr double kDepthSlack_mm = 1;        // of the outermost dots beyond the range
constexpr double kBorder_px = 8;            // free of dots, for their blur and for finding them
constexpr double kGolden = 0.618033988749;  // fraction of a turn from stand to stand: no side is left out
constexpr int kTries = 4000;
constexpr std::uint64_t kStandStream = 7100;  // of the random numbers

struct Stand {
  double z_mm, tilt_rad, azimuth_rad, roll_rad, u_px, v_px;
};

Pose pose_of(const Stand& s, const Lens& camera) {
  const Eigen::Vector2d d = camera.direction(s.u_px, s.v_px);
  Pose T_cam_model = Pose::Identity();
  const Vec3d axis(std::cos(s.azimuth_rad), std::sin(s.azimuth_rad), 0);
  // Facing: columns along the camera's x, z towards it.
  T_cam_model.linear() = (Eigen::AngleAxisd(std::numbers::pi, Vec3d::UnitX()) * Eigen::AngleAxisd(s.tilt_rad, axis) *
                          Eigen::AngleAxisd(s.roll_rad, Vec3d::UnitZ()))
                             .toRotationMatrix();
  T_cam_model.translation() = s.z_mm * Vec3d(d.x(), d.y(), 1);
  return T_cam_model.inverse();
}

bool inside(const Lens& lens, const Vec3d& p, double border_px) {
  double u = 0, v = 0;
  if (!lens.project(p.x(), p.y(), p.z(), u, v)) return false;
  return lens.in_frame(u - border_px, v - border_px) && lens.in_frame(u + border_px, v + border_px);
}

bool fits(const Instrument& instrument, const DotBoardConfig& board, const Pose& T_model_cam, double near_mm,
          double far_mm) {
  const Pose T_cam_model = T_model_cam.inverse();
  const double a = 0.5 * (board.cols - 1) * board.pitch_mm + board.radius_mm;
  const double b = 0.5 * (board.rows - 1) * board.pitch_mm + board.radius_mm;
  for (const double x : {-a, 0.0, a}) {
    for (const double y : {-b, 0.0, b}) {
      const Vec3d c = T_cam_model * Vec3d(x, y, 0);
      if (c.z() < near_mm - kDepthSlack_mm || c.z() > far_mm + kDepthSlack_mm) return false;
      if (!inside(instrument.camera, c, kBorder_px)) return false;
      if (!inside(instrument.projector, instrument.T_proj_cam * c, kBorder_px)) return false;
    }
  }
  return true;
}

}  // namespace

Result<std::vector<Pose>> board_poses(const Instrument& instrument, const DotBoardConfig& board, int count,
                                      std::uint64_t seed) {
  const calib::DepthRange range = instrument.rig.depth_range.value_or(calib::DepthRange{40, 56});
  const auto& image = instrument.rig.camera;
  std::vector<Pose> poses;
  for (int n = 0; n < count; ++n) {
    const CounterRandom random(seed, kStandStream + static_cast<std::uint64_t>(n));
    std::uint64_t draw = 0;
    bool found = false;
    for (int attempt = 0; attempt < kTries && !found; ++attempt) {
      // The stratum of depth widens with the attempts: a tilted board does not fit at either end of the range.
      const double slack = static_cast<double>(attempt) / kTries;
      const double in_stratum = random.uniform(draw++), aside = random.uniform(draw++, -1, 1);
      const double share = (n + in_stratum) / count + slack * aside;
      Stand s{};
      s.z_mm = range.near_mm + (range.far_mm - range.near_mm) * std::clamp(share, 0.0, 1.0);
      s.tilt_rad = kRadPerDeg * random.uniform(draw++, kMinTilt_deg, kMaxTilt_deg);
      s.azimuth_rad = 2 * std::numbers::pi * (n * kGolden + 0.25 * random.uniform(draw++));
      s.roll_rad = kRadPerDeg * random.uniform(draw++, -kMaxRoll_deg, kMaxRoll_deg);
      s.u_px = random.uniform(draw++, 0, image.width - 1);
      s.v_px = random.uniform(draw++, 0, image.height - 1);
      const Pose pose = pose_of(s, instrument.camera);
      found = fits(instrument, board, pose, range.near_mm, range.far_mm);
      if (found) poses.push_back(pose);
    }
    if (!found) {
      return fail(ErrorCode::kConfigValue,
                  "the board does not fit into the field of view within the depth range, stand " + std::to_string(n) +
                      ": smaller board.pitch_mm, cols or rows");
    }
  }
  return poses;
}

}  // namespace enamel::twin
