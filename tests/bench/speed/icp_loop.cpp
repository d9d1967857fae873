// A reference loop: what a plain projective point-to-plane ICP takes (Rusinkiewicz and Levoy 2001), without pyramid,
// robust kernel, prior or texture.
#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <numbers>

#include "tests/bench/speed/float_lens.hpp"
#include "tests/bench/speed/peers.hpp"

namespace enamel::bench {
namespace {

constexpr std::size_t kPoints = 19000;
constexpr int kRounds = 18;
constexpr float kGateMm = 0.5F, kPlaneGateMm = 0.3F, kMinCos = 0.8F;
constexpr std::size_t kChunk = 512;  ///< single-precision sums are carried over into double after so many points

struct Points {
  std::vector<Vec3f> p, n;
};

/// Every k-th point with a normal, k such that kPoints are left.
Points thinned(const SurfacePatch& patch) {
  std::vector<std::size_t> usable;
  for (std::size_t i = 0; i < patch.points.size(); ++i) {
    if (std::isfinite(patch.normals[i].x()) && std::isfinite(patch.points[i].x())) usable.push_back(i);
  }
  Points out;
  const double stride = std::max(1.0, static_cast<double>(usable.size()) / static_cast<double>(kPoints));
  for (double at = 0; at < static_cast<double>(usable.size()); at += stride) {
    const std::size_t i = usable[static_cast<std::size_t>(at)];
    out.p.push_back(patch.points[i]);
    out.n.push_back(patch.normals[i]);
  }
  return out;
}

/// Upper triangle of H, row by row, then g: H x = -g.
using Sums = std::array<float, 27>;

void add(Sums& sums, const std::array<float, 6>& j, float e) {
  std::size_t at = 0;
  for (std::size_t r = 0; r < 6; ++r) {
    for (std::size_t c = r; c < 6; ++c) sums[at++] += j[r] * j[c];
  }
  for (std::size_t r = 0; r < 6; ++r) sums[at++] += j[r] * e;
}

struct Round {
  std::array<double, 27> sums{};
  std::size_t pairs = 0;
};

Round associate(const FloatLens& lens, const SurfacePatch& reference, const Points& moving, const Pose& T_ref_cam) {
  const Eigen::Matrix3f R = T_ref_cam.linear().cast<float>();
  const Vec3f t = T_ref_cam.translation().cast<float>();
  Round out;
  for (std::size_t from = 0; from < moving.p.size(); from += kChunk) {
    Sums sums{};
    for (std::size_t i = from; i < std::min(from + kChunk, moving.p.size()); ++i) {
      const Vec3f p = R * moving.p[i] + t;
      const int pixel = lens.pixel_of(p);
      if (pixel < 0) continue;
      const Vec3f& q = reference.points[static_cast<std::size_t>(pixel)];
      const Vec3f& n = reference.normals[static_cast<std::size_t>(pixel)];
      const Vec3f d = p - q;
      const float e = n.dot(d);
      if (!(d.squaredNorm() < kGateMm * kGateMm && std::abs(e) < kPlaneGateMm)) continue;  // also NaN
      if (!(n.dot(R * moving.n[i]) > kMinCos)) continue;
      const Vec3f turn = p.cross(n);
      add(sums, {turn.x(), turn.y(), turn.z(), n.x(), n.y(), n.z()}, e);
      ++out.pairs;
    }
    for (std::size_t k = 0; k < sums.size(); ++k) out.sums[k] += static_cast<double>(sums[k]);
  }
  return out;
}

Pose stepped(const Round& round, const Pose& T_ref_cam) {
  Eigen::Matrix<double, 6, 6> H;
  Eigen::Matrix<double, 6, 1> g;
  std::size_t at = 0;
  for (int r = 0; r < 6; ++r) {
    for (int c = r; c < 6; ++c) H(r, c) = H(c, r) = round.sums[at++];
  }
  for (int r = 0; r < 6; ++r) g(r) = round.sums[at++];
  const Eigen::Matrix<double, 6, 1> x = -H.ldlt().solve(g);
  const Vec3d turn = x.head<3>();
  Pose step = Pose::Identity();
  if (turn.norm() > 0) step.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  step.translation() = x.tail<3>();
  return step * T_ref_cam;
}

}  // namespace

IcpLoopCost icp_loop(const calib::LensValues& lens, const PlacedPatch& reference, const PlacedPatch& moving,
                     int repeats) {
  const FloatLens eye(lens);
  const Points points = thinned(moving.patch);
  const Pose T_ref_cam = reference.T_model_cam.inverse() * moving.T_model_cam;
  Vec3d middle = Vec3d::Zero();
  for (const Vec3f& p : points.p) middle += p.cast<double>() / static_cast<double>(points.p.size());
  const double off_rad = 0.5 * std::numbers::pi / 180;
  const Pose off = Eigen::Translation3d(T_ref_cam * middle + Vec3d(0.12, -0.12, 0.11)) *
                   Eigen::AngleAxisd(off_rad, Vec3d(1, 2, -1).normalized()) *
                   Eigen::Translation3d(-(T_ref_cam * middle));
  IcpLoopCost out{.cost = {}, .points = points.p.size(), .rounds = kRounds, .pairs = 0, .apart_um = 0};
  out.cost = least_of(repeats, 1, [&] {
    Pose T = off * T_ref_cam;
    out.pairs = 0;
    for (int round = 0; round < kRounds; ++round) {
      const Round sums = associate(eye, reference.patch, points, T);
      out.pairs += static_cast<double>(sums.pairs);
      T = stepped(sums, T);
    }
    out.apart_um = 1e3 * (T * middle - T_ref_cam * middle).norm();
  });
  return out;
}

}  // namespace enamel::bench
