#include "pipeline/algo/decode/rigid_motion.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

constexpr int kNode_px = 8;
constexpr int kPixelStep = 2;      ///< of the pixels that are asked: a quarter of VGA says enough about six unknowns
constexpr int kReach_px = 6;       ///< of the window in which slopes are measured: half a fringe averages ripple away
constexpr int kStep_px = 2;        ///< pixels of the window that are used
constexpr float kMinDet = 4000;    ///< of the 2x2 normal equations: about a quarter of a full window's
constexpr float kMaxSlope = 3.7F;  ///< dz/dx of 75 degrees, the steepest that counts as one surface
constexpr float kMinCosine =
    0.6F;                   ///< of the incidence; slopes of steeper surface are known too badly to judge the motion by
constexpr int kRounds = 3;  ///< each leaves out what the round before could not explain
constexpr int kUnknowns = 7;  ///< V, W, rho
using Vector7 = Eigen::Matrix<double, kUnknowns, 1>;
using Matrix7 = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using Node = RigidMotionWork::Node;

struct Inputs {
  const PhaseMaps& maps;
  const PolarityMaps& polarity;
  const RayDepth& rays;
  const Map<float>& inverse_depth;
  float black_dn;
  Eigen::Vector3f pivot_mm;  ///< turns are about this point
  std::size_t width;
  int columns, rows;
};

/// A - black without the ripple that motion and the second harmonic put on (I0+I2)/2.
void clean_light(const Inputs& in, const Map<float>& rate, const Map<float>& harmonic, Map<float>& out) {
  if (out.width() != rate.width() || out.height() != rate.height()) out = Map<float>(rate.width(), rate.height());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const float c = in.maps.cosine_dn[i], s = in.maps.sine_dn[i];
    const float ripple = rate[i] * s + harmonic[i] * (c - s) * (c + s) / (in.maps.modulation_dn[i] + 1e-6F);
    out[i] = in.maps.mean_dn[i] - in.black_dn - ripple;
  }
}

struct Slopes {
  float q_u = 0, q_v = 0, a_u = 0, a_v = 0;  ///< per pixel
  bool ok = false;
};

/// Slopes of 1/z and of A about pixel (u, v), from pairs of pixels opposite to each other: holes and edges drop out.
Slopes measure_slopes(const Inputs& in, const Map<float>& light, int u, int v) {
  const auto at = static_cast<std::ptrdiff_t>(v) * static_cast<std::ptrdiff_t>(in.width) + u;
  const float q = in.inverse_depth[static_cast<std::size_t>(at)];
  if (!(q > 0)) return {};
  const float per_px =
      kMaxSlope * q *
      std::abs(in.rays.rays.x[static_cast<std::size_t>(at) + 1] - in.rays.rays.x[static_cast<std::size_t>(at)]);
  float uu = 0, uv = 0, vv = 0, qu = 0, qv = 0, au = 0, av = 0;
  for (int dv = 0; dv <= kReach_px; dv += kStep_px) {
    for (int du = dv == 0 ? kStep_px : -kReach_px; du <= kReach_px; du += kStep_px) {
      const std::ptrdiff_t o = static_cast<std::ptrdiff_t>(dv) * static_cast<std::ptrdiff_t>(in.width) + du;
      const auto plus = static_cast<std::size_t>(at + o), minus = static_cast<std::size_t>(at - o);
      const float d = in.inverse_depth[plus] - in.inverse_depth[minus];
      const float x = static_cast<float>(2 * du), y = static_cast<float>(2 * dv);
      if (!(std::abs(d) < per_px * (std::abs(x) + std::abs(y)))) continue;
      const float a = light[plus] - light[minus];
      uu += x * x, uv += x * y, vv += y * y;
      qu += x * d, qv += y * d, au += x * a, av += y * a;
    }
  }
  const float det = uu * vv - uv * uv;
  if (!(det > kMinDet)) return {};
  return {(vv * qu - uv * qv) / det, (uu * qv - uv * qu) / det, (vv * au - uv * av) / det, (uu * av - uv * au) / det,
          true};
}

/// Columns of eps and of dA/B for the six unknowns at a node (equations of the header).
Node make_node(const Inputs& in, const Map<float>& light, int u, int v) {
  Node node;
  const Slopes s = measure_slopes(in, light, u, v);
  if (!s.ok) return node;
  const std::size_t i = static_cast<std::size_t>(v) * in.width + static_cast<std::size_t>(u);
  const float x = in.rays.rays.x[i], y = in.rays.rays.y[i], q = in.inverse_depth[i];
  const float per_x = in.rays.rays.x[i + 1] - x, per_y = in.rays.rays.y[i + in.width] - y;
  const float phase = in.maps.phase_rad[i] + kTwoPiF * static_cast<float>(in.polarity.turn[i]);
  const float slope = in.rays.inverse_depth_slope(i, phase);
  const float b = in.maps.modulation_dn[i];
  if (!(std::abs(slope) > 0) || !(b > 1)) return node;
  const Eigen::Vector3f r(x, y, 1);
  Eigen::Vector3f m(s.q_u / per_x, s.q_v / per_y, 0);
  m.z() = q - m.x() * x - m.y() * y;
  node.fits = q > kMinCosine * m.norm() * r.norm();
  for (int k = 0; k < 6; ++k) {
    const Eigen::Vector3f axis = Eigen::Vector3f::Unit(k % 3);
    const Eigen::Vector3f moved = k < 3 ? Eigen::Vector3f(q * axis) : axis.cross(r - q * in.pivot_mm);  // U q
    const float du = (moved.x() - x * moved.z()) / per_x, dv = (moved.y() - y * moved.z()) / per_y;
    node.rate[static_cast<std::size_t>(k)] = -m.dot(moved) / slope;
    node.light[static_cast<std::size_t>(k)] = (-s.a_u * du - s.a_v * dv - 2 * light[i] * moved.z()) / b;
  }
  node.ok = true;
  return node;
}

std::size_t centre_of(const Inputs& in, int column, int row) {
  return static_cast<std::size_t>(row * kNode_px + kNode_px / 2) * in.width +
         static_cast<std::size_t>(column * kNode_px + kNode_px / 2);
}

void make_nodes(const Inputs& in, const Map<float>& light, std::vector<Node>& nodes) {
  nodes.assign(static_cast<std::size_t>(in.columns) * static_cast<std::size_t>(in.rows), {});
  const int margin = (kReach_px + kNode_px) / kNode_px;
  for (int row = margin; row < in.rows - margin; ++row) {
    for (int column = margin; column < in.columns - margin; ++column) {
      if (in.maps.reject[centre_of(in, column, row)] != PixelReject::kNone) continue;
      nodes[static_cast<std::size_t>(row) * static_cast<std::size_t>(in.columns) + static_cast<std::size_t>(column)] =
          make_node(in, light, column * kNode_px + kNode_px / 2, row * kNode_px + kNode_px / 2);
    }
  }
}

/// Columns of one pixel's residual: for eps, for dA/B, for rho (closure.hpp). `rate`, eps as known so far, makes the
/// first exact to second order.
struct Columns {
  float rate, light, harmonic, residual;
  bool used;
};

Columns columns_at(const Inputs& in, std::size_t i, float rate, float max_residual) {
  const float c = in.maps.cosine_dn[i], s = in.maps.sine_dn[i], b = in.maps.modulation_dn[i];
  const float r = in.maps.code_dn[i], w = in.polarity.weight[i];
  const float share = b / larger(in.maps.mean_dn[i] - in.black_dn, 1);
  const bool plus = w > 0;
  Columns out{};
  out.used = in.maps.reject[i] == PixelReject::kNone && std::abs(w) > 0.999F && std::abs(r) < max_residual * b;
  out.rate = plus ? 2 * (s - c) * (1 + rate) : -2 * (c - rate * s);
  out.light = plus ? -2 * b - 2 * share * (c + s) : 2 * b - 2 * share * s;
  out.harmonic = plus ? 4 * (c - s) * (c + s) / (b + 1e-6F) : 0;
  out.residual = r;
  return out;
}

struct Equations {
  Matrix7 left = Matrix7::Zero();
  Vector7 right = Vector7::Zero();
  double squares = 0;
  std::size_t pixels = 0;
};

/// Adds one node's block of pixels; residuals farther than `limit` from what `theta` predicts are left out.
void add_node(const Inputs& in, const Node& node, int column, int row, const Vector7& theta, double limit,
              float max_residual, Equations& out) {
  Vector7 rate = Vector7::Zero(), light = Vector7::Zero();
  for (int k = 0; k < 6; ++k) {
    rate[k] = static_cast<double>(node.rate[static_cast<std::size_t>(k)]);
    light[k] = static_cast<double>(node.light[static_cast<std::size_t>(k)]);
  }
  const double eps = rate.dot(theta), change = light.dot(theta), rho = theta[6];
  double rr = 0, rl = 0, ll = 0, rh = 0, lh = 0, hh = 0, ry = 0, ly = 0, hy = 0;
  for (int v = row * kNode_px; v < (row + 1) * kNode_px; v += kPixelStep) {
    for (int u = column * kNode_px + v / kPixelStep % kPixelStep; u < (column + 1) * kNode_px; u += kPixelStep) {
      const Columns c = columns_at(in, static_cast<std::size_t>(v) * in.width + static_cast<std::size_t>(u),
                                   static_cast<float>(eps), max_residual);
      if (!c.used) continue;
      const auto x = static_cast<double>(c.rate), l = static_cast<double>(c.light), h = static_cast<double>(c.harmonic);
      const auto y = static_cast<double>(c.residual);
      const double left_over = y - x * eps - l * change - h * rho;
      if (std::abs(left_over) > limit) continue;
      rr += x * x, rl += x * l, ll += l * l, rh += x * h, lh += l * h, hh += h * h, ry += x * y, ly += l * y,
          hy += h * y;
      out.squares += left_over * left_over;
      ++out.pixels;
    }
  }
  out.left += rr * rate * rate.transpose() + rl * (rate * light.transpose() + light * rate.transpose()) +
              ll * light * light.transpose();
  const Vector7 cross = rh * rate + lh * light;
  out.left.col(6) += cross;
  out.left.row(6) += cross.transpose();
  out.left(6, 6) += hh;
  out.right += ry * rate + ly * light;
  out.right[6] += hy;
}

Equations gather(const Inputs& in, const std::vector<Node>& nodes, const Vector7& theta, double limit,
                 float max_residual) {
  Equations out;
  for (int row = 0; row < in.rows; ++row) {
    for (int column = row % 2; column < in.columns; column += 2) {  // every second node says enough
      const Node& node = nodes[static_cast<std::size_t>(row) * static_cast<std::size_t>(in.columns) +
                               static_cast<std::size_t>(column)];
      if (node.ok && node.fits) add_node(in, node, column, row, theta, limit, max_residual, out);
    }
  }
  return out;
}

Vector7 solve(Equations e, const RigidMotionConfig& config) {
  const double variance = e.squares / static_cast<double>(std::max<std::size_t>(e.pixels, 1));
  Vector7 spread;
  spread << Eigen::Vector3d::Constant(config.shift_prior_mm), Eigen::Vector3d::Constant(config.turn_prior_rad),
      config.harmonic_prior;
  e.left.diagonal() += variance * spread.cwiseInverse().cwiseAbs2();
  return e.left.ldlt().solve(e.right);
}

std::optional<Vector7> solve_robustly(const Inputs& in, const std::vector<Node>& nodes,
                                      const RigidMotionConfig& config) {
  Vector7 theta = Vector7::Zero();
  double limit = std::numeric_limits<double>::max();
  for (int round = 0; round < kRounds; ++round) {
    const Equations e = gather(in, nodes, theta, limit, config.max_residual);
    if (e.pixels < config.min_pixels) return std::nullopt;
    theta = solve(e, config);
    limit = static_cast<double>(config.outlier_sigmas) * std::sqrt(e.squares / static_cast<double>(e.pixels));
  }
  return theta;
}

/// Motion at every pixel: bilinear between nodes; a node without slope takes the coarse rate of its block.
void spread_field(const Inputs& in, const ClosureFit& coarse, const Vector7& theta, RigidMotionWork& work,
                  MotionField& field) {
  const std::size_t count = work.nodes.size();
  work.node_rate.resize(count), work.node_light.resize(count);
  for (std::size_t n = 0; n < count; ++n) {
    const Node& node = work.nodes[n];
    const auto column = static_cast<int>(n % static_cast<std::size_t>(in.columns)),
               row = static_cast<int>(n / static_cast<std::size_t>(in.columns));
    float rate = 0, light = 0;
    for (std::size_t k = 0; k < 6; ++k) {
      rate += node.rate[k] * static_cast<float>(theta[static_cast<Eigen::Index>(k)]);
      light += node.light[k] * static_cast<float>(theta[static_cast<Eigen::Index>(k)]);
    }
    work.node_rate[n] = node.ok ? rate : coarse.block_motion_rad[coarse.block_at(column * kNode_px, row * kNode_px)];
    work.node_light[n] = light;
  }
  interpolate_grid(work.node_rate.data(), in.columns, in.rows, kNode_px, field.rate_rad);
  interpolate_grid(work.node_light.data(), in.columns, in.rows, kNode_px, field.light);
}

}  // namespace

bool stands_still(const ClosureFit& coarse, const RigidMotionConfig& config) {
  std::size_t seen = 0, moving = 0;
  for (std::size_t k = 0; k < coarse.block_motion_rad.size(); ++k) {
    if (coarse.block_pixels[k] < config.min_block_pixels) continue;
    ++seen;
    moving += std::abs(coarse.block_motion_rad[k]) > config.negligible_rad ? 1U : 0U;
  }
  return 4 * moving < seen;
}

RigidMotion fit_rigid_motion(const PhaseMaps& maps, const PolarityMaps& polarity, const ClosureFit& coarse,
                             const RayDepth& rays, const Map<float>& inverse_depth, float black_dn, bool refine,
                             const RigidMotionConfig& config, RigidMotionWork& work, MotionField& field) {
  const Inputs in{maps,
                  polarity,
                  rays,
                  inverse_depth,
                  black_dn,
                  {0, 0, 2 / (1 / rays.near_mm + 1 / rays.far_mm)},
                  static_cast<std::size_t>(maps.phase_rad.width()),
                  maps.phase_rad.width() / kNode_px,
                  maps.phase_rad.height() / kNode_px};
  RigidMotion out;
  field.resize(maps.phase_rad.width(), maps.phase_rad.height());
  clean_light(in, refine ? field.rate_rad : coarse.pixel_motion_rad, coarse.pixel_harmonic, work.light);
  make_nodes(in, work.light, work.nodes);
  const auto found = solve_robustly(in, work.nodes, config);
  if (!found) return out;
  const Vector7& theta = *found;
  spread_field(in, coarse, theta, work, field);
  for (std::size_t k = 0; k < 3; ++k) {
    out.shift_mm[k] = theta[static_cast<Eigen::Index>(k)];
    out.turn_rad[k] = theta[static_cast<Eigen::Index>(k + 3)];
  }
  out.about_mm = static_cast<double>(in.pivot_mm.z());
  out.moved = true;
  return out;
}

}  // namespace enamel::algo
