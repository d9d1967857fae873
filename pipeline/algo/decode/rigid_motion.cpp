#include "pipeline/algo/decode/rigid_motion.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "pipeline/algo/decode/motion_rows.hpp"
#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

constexpr float kMinDet = 4000;    ///< of the 2x2 normal equations: about a quarter of a full window's
constexpr float kMaxSlope = 3.7F;  ///< dz/dx of 75 degrees, the steepest that counts as one surface
constexpr float kMinCosine =
    0.6F;  ///< of the incidence; slopes of steeper surface are known too badly to judge the motion by
constexpr float kMinLitCosine = 0.2F;  ///< of the light's incidence; beyond, slopes are known too badly to tell it
constexpr float kMostGrowth = 0.3F;    ///< of light, per frame interval; more is no surface sliding by
constexpr int kRounds = 3;             ///< each leaves out what the round before could not explain
constexpr int kUnknowns = 7;           ///< V, W, and what all pixels share
using Vector7 = Eigen::Matrix<double, kUnknowns, 1>;
using Matrix7 = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using Theta = std::array<double, kUnknowns>;

enum NodeQuality : std::uint8_t { kNoSlope, kTooSteep, kFits };

/// How a point's own light changes, as share of it: by its motion U q, and by the turn of its surface.
struct Shading {
  Eigen::Vector3f of_shift, of_turn;
};

/// Eigen adds up three floats in another order where registers hold two, as NEON's do.
float dot(const Eigen::Vector3f& a, const Eigen::Vector3f& b) { return a.x() * b.x() + a.y() * b.y() + a.z() * b.z(); }

/// Lambert's law from a lens that darkens by the fourth power of the cosine: light goes as (axis.l)^4 n.l / |l|^7, l
/// from the point to the projector. m: along n; to_light: l q; axis: the projector's.
Shading shading_of(const Eigen::Vector3f& m, const Eigen::Vector3f& to_light, const Eigen::Vector3f& axis) {
  const float distance2 = dot(to_light, to_light), grazing = -kMinLitCosine * std::sqrt(dot(m, m) * distance2);
  const float facing = std::min(dot(m, to_light), grazing);  // m points away from camera and projector
  return {7 / distance2 * to_light - 4 / dot(axis, to_light) * axis - m / facing, m.cross(to_light) / facing};
}

/// One pass over the burst, with the slopes that the errors known so far leave.
class Pass {
 public:
  Pass(MotionView& view, const PhaseMaps& maps, const Map<std::int16_t>& turn, const RayDepth& rays,
       const RigidMotionConfig& config, RigidMotionWork& work)
      : view_(view),
        maps_(maps),
        turn_(turn),
        rays_(rays),
        config_(config),
        work_(work),
        columns_(maps.phase_rad.width() / kNode_px),
        rows_(maps.phase_rad.height() / kNode_px),
        count_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)),
        pivot_mm_(0, 0, 2 / (1 / rays.near_mm + 1 / rays.far_mm)) {}

  std::optional<Theta> run(const MotionField* known) {
    view_.take_samples(known, work_.samples);
    view_.make_images(known, work_.images);
    make_nodes();
    take_columns();
    return solve_robustly();
  }

  /// Motion at every node; one without slope takes the coarse rate of its block.
  void spread(const Theta& theta, MotionField& field) const {
    field.columns = columns_;
    field.detail = 1;
    field.rows = rows_;
    field.rate_rad.resize(count_);
    field.light.resize(count_);
    field.shared = static_cast<float>(theta[6]);
    for (std::size_t n = 0; n < count_; ++n) {
      float rate = 0, light = 0;
      for (std::size_t k = 0; k < 6; ++k) {
        rate += work_.rate[k * count_ + n] * static_cast<float>(theta[k]);
        light += work_.light[k * count_ + n] * static_cast<float>(theta[k]);
      }
      const int column = static_cast<int>(n) % columns_, row = static_cast<int>(n) / columns_;
      field.rate_rad[n] = work_.quality[n] != kNoSlope ? rate : rate_without_slope(theta, column, row);
      field.light[n] = std::clamp(light, -kMostGrowth, kMostGrowth);
    }
    spread_changes(theta, field);
  }

 private:
  [[nodiscard]] std::size_t pixel_of(int column, int row) const {
    return maps_.phase_rad.index(column * kNode_px + kNode_px / 2, row * kNode_px + kNode_px / 2);
  }

  /// That of the block; where it does not tell, of a surface that faces the camera in the middle of the range.
  [[nodiscard]] float rate_without_slope(const Theta& theta, int column, int row) const {
    const float of_block = view_.block_rate(column * kNode_px, row * kNode_px);
    if (of_block == of_block) return of_block;
    const std::size_t i = pixel_of(column, row);
    const float q = rays_.c0[i], x = rays_.rays.x[i] / q, y = rays_.rays.y[i] / q;
    const float away =
        static_cast<float>(theta[2]) + static_cast<float>(theta[3]) * y - static_cast<float>(theta[4]) * x;
    return -q * q * away / rays_.c1[i];
  }

  /// The same in tables of every second pixel.
  [[nodiscard]] std::size_t sparse_pixel_of(int column, int row) const {
    static_assert(kNode_px % 4 == 0);
    const int width = (maps_.phase_rad.width() + 1) / 2;
    return static_cast<std::size_t>((row * kNode_px + kNode_px / 2) / 2 * width +
                                    (column * kNode_px + kNode_px / 2) / 2);
  }

  /// Rate and light are properties of the surface, and pass by with it: d/dt = -(image motion).grad.
  void spread_changes(const Theta& theta, MotionField& field) const {
    field.rate_change_rad.assign(count_, 0.0F);
    field.light_change.assign(count_, 0.0F);
    const Eigen::Vector3f shift(static_cast<float>(theta[0]), static_cast<float>(theta[1]),
                                static_cast<float>(theta[2]));
    const Eigen::Vector3f turn(static_cast<float>(theta[3]), static_cast<float>(theta[4]),
                               static_cast<float>(theta[5]));
    const auto pitch = static_cast<std::size_t>(columns_);
    for (int row = 0; row < rows_; ++row) {
      const float* inverse_depth = work_.images.inverse_depth.around(row, 0, 0);
      for (int column = 0; column < columns_; ++column) {
        const std::size_t n = static_cast<std::size_t>(row) * pitch + static_cast<std::size_t>(column);
        const float q = inverse_depth[column];
        if (work_.quality[n] == kNoSlope || !(q > 0)) continue;
        const std::size_t i = pixel_of(column, row), width = static_cast<std::size_t>(maps_.phase_rad.width());
        const float x = rays_.rays.x[i], y = rays_.rays.y[i];
        const Eigen::Vector3f u = q * shift + turn.cross(Eigen::Vector3f(x, y, 1) - q * pivot_mm_);
        const float nodes = 1 / static_cast<float>(kNode_px);  // per pixel
        const float right = nodes * (u.x() - x * u.z()) / (rays_.rays.x[i + 1] - x);
        const float down = nodes * (u.y() - y * u.z()) / (rays_.rays.y[i + width] - y);
        const auto passing = [&](const std::vector<float>& f) {
          return -right * step(f, n, 1, column, columns_) - down * step(f, n, pitch, row, rows_);
        };
        field.rate_change_rad[n] = passing(field.rate_rad);
        field.light_change[n] = passing(field.light) + field.light[n] * field.light[n];
      }
    }
  }

  /// Change of f from node to node along an axis, node n being the at-th of `count`: central; one-sided where one
  /// neighbour has no slope.
  [[nodiscard]] float step(const std::vector<float>& f, std::size_t n, std::size_t pitch, int at, int count) const {
    const bool before = at > 0 && work_.quality[n - pitch] != kNoSlope;
    const bool after = at + 1 < count && work_.quality[n + pitch] != kNoSlope;
    if (before && after) return 0.5F * (f[n + pitch] - f[n - pitch]);
    return (after ? f[n + pitch] : f[n]) - (before ? f[n - pitch] : f[n]);
  }

  void make_nodes() {
    work_.rate.assign(6 * count_, 0.0F);
    work_.light.assign(6 * count_, 0.0F);
    work_.quality.assign(count_, kNoSlope);
    const auto n = static_cast<std::size_t>(columns_);
    work_.slopes.resize(6 * n);
    float* s = work_.slopes.data();
    const SlopeRow slopes{s, s + n, s + 2 * n, s + 3 * n, s + 4 * n, s + 5 * n};
    for (int row = 1; row < rows_ - 1; ++row) {
      const float* q = work_.images.inverse_depth.around(row, 0, 0);
      for (int column = 1; column < columns_ - 1; ++column) {
        const std::size_t i = pixel_of(column, row);
        s[column] = kMaxSlope * q[column] * std::abs(rays_.rays.x[i + 1] - rays_.rays.x[i]);
      }
      slope_row(work_.images, row, 1, columns_ - 1, slopes);
      for (int column = 1; column < columns_ - 1; ++column) make_node(slopes, column, row);
    }
    extend_to_borders();
  }

  /// Nodes at the image's border lack half their window: what the two next to them say goes on in a straight line.
  void extend_to_borders() {
    if (columns_ < 3 || rows_ < 3) return;
    const auto pitch = static_cast<std::size_t>(columns_), below = static_cast<std::size_t>(rows_ - 1) * pitch;
    for (std::size_t row = 1; row + 1 < static_cast<std::size_t>(rows_); ++row) {
      extend(row * pitch, row * pitch + 1, row * pitch + 2);
      extend((row + 1) * pitch - 1, (row + 1) * pitch - 2, (row + 1) * pitch - 3);
    }
    for (std::size_t column = 0; column < pitch; ++column) {
      extend(column, column + pitch, column + 2 * pitch);
      extend(below + column, below + column - pitch, below + column - 2 * pitch);
    }
  }
  void extend(std::size_t to, std::size_t next, std::size_t second) {
    if (work_.quality[next] == kNoSlope) return;
    const bool line = work_.quality[second] != kNoSlope;
    for (auto* columns : {&work_.rate, &work_.light}) {
      for (std::size_t k = 0; k < 6; ++k) {
        float* c = columns->data() + k * count_;
        c[to] = line ? 2 * c[next] - c[second] : c[next];
      }
    }
    work_.quality[to] = kTooSteep;  // known, and not asked
  }

  /// Columns of eps and of dA/A for the six unknowns (equations of the header).
  void make_node(const SlopeRow& slopes, int column, int row) {
    const std::size_t i = pixel_of(column, row), width = static_cast<std::size_t>(maps_.phase_rad.width());
    const float q = work_.images.inverse_depth.around(row, 0, 0)[column], det = slopes.det[column];
    const float phase = maps_.phase_rad[i] + kTwoPiF * static_cast<float>(turn_[i]);
    const float slope = rays_.sparse.slope(sparse_pixel_of(column, row), phase),
                light = work_.images.light.around(row, 0, 0)[column];
    if (!(q > 0) || !(det > kMinDet) || !(std::abs(slope) > 0) || !(light > 1)) return;
    const float x = rays_.rays.x[i], y = rays_.rays.y[i];
    const float per_x = 1 / (rays_.rays.x[i + 1] - x), per_y = 1 / (rays_.rays.y[i + width] - y);
    const float a_u = slopes.a_u[column] / det * per_x, a_v = slopes.a_v[column] / det * per_y;  // per unit of r
    const Eigen::Vector3f r(x, y, 1);
    Eigen::Vector3f m(slopes.q_u[column] / det * per_x, slopes.q_v[column] / det * per_y, 0);
    m.z() = q - m.x() * x - m.y() * y;
    // Rate and light are linear in the point's motion U q, so two vectors say it for all shifts and turns.
    const Eigen::Vector3f of_rate = -m / slope;
    const Shading shading = shading_of(m, q * rays_.projector_mm - r, rays_.projector_axis);
    // Of A, what slides by is the surface's: the camera's own falloff, (1 + x^2 + y^2)^-2, stays with the pixel.
    const float falloff = 4 / (1 + x * x + y * y), l_u = a_u / light + falloff * x, l_v = a_v / light + falloff * y;
    const Eigen::Vector3f of_light = Eigen::Vector3f(-l_u, -l_v, l_u * x + l_v * y) + shading.of_shift;
    const Eigen::Vector3f arm = r - q * pivot_mm_;  // (W x arm).f = W.(arm x f)
    const Eigen::Vector3f turn_rate = arm.cross(of_rate), turn_light = arm.cross(of_light) + shading.of_turn;
    const std::size_t n =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      work_.rate[k * count_ + n] = q * of_rate[axis];
      work_.rate[(k + 3) * count_ + n] = turn_rate[axis];
      work_.light[k * count_ + n] = q * of_light[axis];
      work_.light[(k + 3) * count_ + n] = turn_light[axis];
    }
    work_.quality[n] = q > kMinCosine * std::sqrt(dot(m, m) * dot(r, r)) ? kFits : kTooSteep;
  }

  /// Of the sampled nodes.
  void take_columns() {
    const MotionSamples& samples = work_.samples;
    MotionColumns& out = work_.columns;
    out.rate.assign(6 * samples.nodes, 0.0F);
    out.light.assign(6 * samples.nodes, 0.0F);
    out.counts.assign(samples.nodes, 0.0F);
    out.by_node.assign(2 * kColumnLanes * samples.nodes, 0.0F);
    for (std::size_t s = 0; s < samples.node.size(); ++s) {
      const auto n = static_cast<std::size_t>(samples.node[s]);
      if (work_.quality[n] != kFits) continue;
      out.counts[s] = 1;
      for (std::size_t k = 0; k < 6; ++k) {
        out.rate[k * samples.nodes + s] = work_.rate[k * count_ + n];
        out.light[k * samples.nodes + s] = work_.light[k * count_ + n];
        out.by_node[2 * kColumnLanes * s + k] = work_.rate[k * count_ + n];
        out.by_node[2 * kColumnLanes * s + kColumnLanes + k] = work_.light[k * count_ + n];
      }
    }
  }

  [[nodiscard]] Theta solve(const MotionEquations& e) const {
    Matrix7 left;
    Vector7 right, spread;
    for (int row = 0; row < kUnknowns; ++row) {
      right[row] = e.right[static_cast<std::size_t>(row)];
      for (int column = row; column < kUnknowns; ++column)
        left(row, column) = left(column, row) = e.left[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
    }
    spread << Eigen::Vector3d::Constant(config_.shift_prior_mm), Eigen::Vector3d::Constant(config_.turn_prior_rad),
        config_.shared_prior;
    left.diagonal() +=
        static_cast<double>(kNodePixels) * e.squares / std::max(e.pixels, 1.0) * spread.cwiseInverse().cwiseAbs2();
    const Vector7 theta = left.ldlt().solve(right);
    Theta out{};
    std::copy_n(theta.data(), kUnknowns, out.begin());
    return out;
  }

  [[nodiscard]] std::optional<Theta> solve_robustly() const {
    Theta theta{};
    double limit = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kRounds; ++round) {
      MotionEquations e;
      add_samples(work_.samples, work_.columns, theta, limit, e);
      if (e.pixels < static_cast<double>(config_.min_pixels)) return std::nullopt;
      theta = solve(e);
      limit = static_cast<double>(config_.outlier_sigmas) * std::sqrt(e.squares / e.pixels);
    }
    return theta;
  }

  MotionView& view_;
  const PhaseMaps& maps_;
  const Map<std::int16_t>& turn_;
  const RayDepth& rays_;
  const RigidMotionConfig& config_;
  RigidMotionWork& work_;
  int columns_, rows_;
  std::size_t count_;
  Eigen::Vector3f pivot_mm_;  ///< turns are about this point
};

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

RigidMotion fit_rigid_motion(MotionView& view, const PhaseMaps& maps, const Map<std::int16_t>& turn,
                             const RayDepth& rays, int passes, const RigidMotionConfig& config, RigidMotionWork& work,
                             MotionField& field) {
  RigidMotion out;
  Pass pass(view, maps, turn, rays, config, work);
  for (int k = 0; k < passes; ++k) {
    const auto theta = pass.run(out.moved ? &field : nullptr);
    if (!theta) return {};
    pass.spread(*theta, field);
    std::copy_n(theta->begin(), 3, out.shift_mm.begin());
    std::copy_n(theta->begin() + 3, 3, out.turn_rad.begin());
    out.about_mm = static_cast<double>(2 / (1 / rays.near_mm + 1 / rays.far_mm));
    out.moved = true;
  }
  return out;
}

}  // namespace enamel::algo
