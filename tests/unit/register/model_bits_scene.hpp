// Bursts of a curved surface decoded, fused and registered: the field's bits and a pose that are the same on every
// machine. Shared by the unit test and by the program that is cross-compiled for arm64.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/model/fuse/tsdf_model.hpp"
#include "pipeline/register/icp/icp.hpp"
#include "protocol/base/crc32.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::test {

struct ModelBits {
  std::uint32_t field = 0, view = 0;
  bool registered = false;
  Pose T_model_cam = Pose::Identity();
};

/// Change only when the arithmetic of decoding, fusion or view changes; set anew then.
inline constexpr std::uint32_t kFieldBits = 919168385, kViewBits = 840447319;
/// Rows of the pose that registration ends with; a row is three of rotation and one of translation, mm.
inline constexpr double kRegistered[3][4] = {
    {0.99999999407212259, -7.0622355104747105e-06, 0.00010865486481469407, 1.4969248793681156},
    {7.0976353656064535e-06, 0.99999994690069172, -0.00032580398602514624, -2.2396942651411087},
    {-0.00010865255814071635, 0.00032580475528643134, 0.99999994102293976, 2.998212063744274}};

/// A saddle with a slant, by sums and products alone: the same input from every mathematics library.
inline pipeline::DecodedBurst saddle_burst(const calib::Rig& rig, std::uint64_t seed) {
  SceneOptions o = noisy();
  o.seed = seed;
  const auto depth = [](int u, int v) {
    const double x = (u - 150) / 100.0, y = (v - 85) / 100.0;
    return 47.5 + 0.25 * (x * x - 1) * (x * x - 1) - 1.6 * y * y + 1.5 * x * y + 1.5 * y * y * y + 0.8 * x * x * y;
  };
  return pipeline::BurstDecoder::make(rig).value().decode(render(rig, depth, o).frames.view());
}

inline std::uint32_t field_crc(const pipeline::BlockGrid& grid) {
  std::uint32_t crc = 0;
  for (std::size_t id = 0; id < grid.size(); ++id) {
    const pipeline::Block& block = grid.block(static_cast<std::int32_t>(id));
    crc = crc32(std::as_bytes(std::span(block.index)), crc);
    crc = crc32(std::as_bytes(std::span(block.distance_mm)), crc);
    crc = crc32(std::as_bytes(std::span(block.weight)), crc);
    crc = crc32(std::as_bytes(std::span(block.observations)), crc);
  }
  return crc;
}

/// Beside where the third burst was taken: 0.12 mm and 0.6 degrees.
inline Pose beside(const Pose& T) {
  Pose off = Pose::Identity();
  off.linear() = Eigen::Quaterniond(1, 0.003, -0.004, 0.002).normalized().toRotationMatrix();
  off.translation() = Vec3d(0.08, -0.06, 0.07) - (off.linear() * Vec3d(0, 0, 48) - Vec3d(0, 0, 48));
  return T * off;
}

/// Two bursts fused, the second a little turned, and a third laid on the view of them.
inline ModelBits model_bits() {
  const calib::Rig rig = cropped_rig(320, 160);
  Pose T_first = Pose::Identity(), T_second = Pose::Identity();
  T_first.translation() = Vec3d(1.5, -2.25, 3);
  T_second.linear() = Eigen::Quaterniond(1, 0.0001, 0, 0.00005).normalized().toRotationMatrix();
  T_second.translation() = T_first.translation() + Vec3d(0.004, 0, -0.003);
  pipeline::TsdfModel model(rig);
  const pipeline::DecodedBurst first = saddle_burst(rig, 1), third = saddle_burst(rig, 3);
  model.integrate(BurstId{1}, first.patch, T_first);
  model.integrate(BurstId{2}, saddle_burst(rig, 2).patch, T_second);
  const ModelView view = model.view(T_first, first.patch);
  ModelBits out;
  out.field = field_crc(model.grid());
  out.view = crc32(std::as_bytes(view.points.pixels()));
  out.view = crc32(std::as_bytes(view.normals.pixels()), out.view);
  const pipeline::IcpConfig config;
  const pipeline::Reference reference(view, config.reference);
  const Pose start = beside(T_first);
  const pipeline::IcpResult found =
      align(make_pyramid(third.patch, config), reference, pipeline::ViewCamera(rig.camera), start, start, config);
  out.registered = found.converged;
  out.T_model_cam = found.T_model_cam;
  return out;
}

/// Largest distance of the corners of the burst's surface between two poses, mm.
inline double apart_mm(const Pose& a, const Pose& b) {
  double most = 0;
  for (const Vec3d& corner : {Vec3d(-4, -2, 47), Vec3d(4, -2, 47), Vec3d(-4, 2, 49), Vec3d(4, 2, 49)})
    most = std::max(most, (a * corner - b * corner).norm());
  return most;
}

inline Pose registered_pose() {
  Pose T = Pose::Identity();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) T(r, c) = kRegistered[r][c];
  return T;
}

}  // namespace enamel::test
