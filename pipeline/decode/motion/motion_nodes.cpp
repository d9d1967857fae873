#include "pipeline/decode/motion/motion_nodes.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "pipeline/decode/motion/chosen.hpp"
#include "pipeline/decode/motion/motion_rows.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {
namespace {

/// derived: dz/dx of 75 degrees, the steepest that counts as one surface (LinkConfig).
constexpr float kMaxSlope = 3.7F;

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

class NodeFinder {
 public:
  NodeFinder(const MotionImages& images, const PhaseMaps& maps, const Map<std::int16_t>& wraps, const RayDepth& rays,
             MotionNodes& out)
      : images_(images), maps_(maps), wraps_(wraps), rays_(rays), out_(out), pivot_mm_(0, 0, pivot_depth_mm(rays)) {}

  void run() {
    out_.columns = maps_.phase_rad.width() / kNode_px;
    out_.rows = maps_.phase_rad.height() / kNode_px;
    out_.rate.assign(6 * out_.count(), 0.0F);
    out_.light.assign(6 * out_.count(), 0.0F);
    out_.quality.assign(out_.count(), NodeQuality::kNoSlope);
    const auto n = static_cast<std::size_t>(out_.columns);
    out_.slopes.resize(6 * n);
    float* s = out_.slopes.data();
    const SlopeRow slopes{s, s + n, s + 2 * n, s + 3 * n, s + 4 * n, s + 5 * n};
    for (int row = 1; row < out_.rows - 1; ++row) {
      const float* q = images_.inverse_depth.around(row, 0, 0);
      for (int column = 1; column < out_.columns - 1; ++column) {
        const std::size_t i = pixel_of_node(maps_, column, row);
        s[column] = kMaxSlope * q[column] * std::abs(rays_.rays.x[i + 1] - rays_.rays.x[i]);
      }
      slope_row(images_, row, 1, out_.columns - 1, slopes);
      for (int column = 1; column < out_.columns - 1; ++column) make_node(slopes, column, row);
    }
    extend_to_borders();
  }

 private:
  /// The node's pixel in tables of every second pixel.
  [[nodiscard]] std::size_t sparse_pixel_of(int column, int row) const {
    static_assert(kNode_px % 4 == 0);
    const int width = (maps_.phase_rad.width() + 1) / 2;
    return static_cast<std::size_t>((row * kNode_px + kNode_px / 2) / 2 * width +
                                    (column * kNode_px + kNode_px / 2) / 2);
  }

  /// Columns of eps and of dA/A for the six unknowns.
  void make_node(const SlopeRow& slopes, int column, int row) {
    const std::size_t i = pixel_of_node(maps_, column, row);
    const auto width = static_cast<std::size_t>(maps_.phase_rad.width());
    const float q = images_.inverse_depth.around(row, 0, 0)[column], det = slopes.det[column];
    const float phase = maps_.phase_rad[i] + kTwoPiF * static_cast<float>(wraps_[i]);
    const float slope = rays_.sparse.slope(sparse_pixel_of(column, row), phase),
                light = images_.light.around(row, 0, 0)[column];
    if (!(q > 0) || !(det > kMinNodeDet) || !(std::abs(slope) > 0) || !(light > 1)) return;
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
    const std::size_t count = out_.count();
    const std::size_t n =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(out_.columns) + static_cast<std::size_t>(column);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      out_.rate[k * count + n] = q * of_rate[axis];
      out_.rate[(k + 3) * count + n] = turn_rate[axis];
      out_.light[k * count + n] = q * of_light[axis];
      out_.light[(k + 3) * count + n] = turn_light[axis];
    }
    out_.quality[n] =
        q > kMinNodeCosine * std::sqrt(dot(m, m) * dot(r, r)) ? NodeQuality::kFits : NodeQuality::kTooSteep;
  }

  /// Nodes at the image's border lack half their window: what the two next to them say goes on in a straight line.
  void extend_to_borders() {
    if (out_.columns < 3 || out_.rows < 3) return;
    const auto pitch = static_cast<std::size_t>(out_.columns), height = static_cast<std::size_t>(out_.rows);
    const std::size_t below = (height - 1) * pitch;
    for (std::size_t row = 1; row + 1 < height; ++row) {
      extend(row * pitch, row * pitch + 1, row * pitch + 2);
      extend((row + 1) * pitch - 1, (row + 1) * pitch - 2, (row + 1) * pitch - 3);
    }
    for (std::size_t column = 0; column < pitch; ++column) {
      extend(column, column + pitch, column + 2 * pitch);
      extend(below + column, below + column - pitch, below + column - 2 * pitch);
    }
  }

  void extend(std::size_t to, std::size_t next, std::size_t second) {
    if (!out_.has_slope(next)) return;
    const bool line = out_.has_slope(second);
    for (auto* columns : {&out_.rate, &out_.light}) {
      for (std::size_t k = 0; k < 6; ++k) {
        float* c = columns->data() + k * out_.count();
        c[to] = line ? 2 * c[next] - c[second] : c[next];
      }
    }
    out_.quality[to] = NodeQuality::kTooSteep;
  }

  const MotionImages& images_;
  const PhaseMaps& maps_;
  const Map<std::int16_t>& wraps_;
  const RayDepth& rays_;
  MotionNodes& out_;
  Eigen::Vector3f pivot_mm_;
};

}  // namespace

void find_nodes(const MotionImages& images, const PhaseMaps& maps, const Map<std::int16_t>& wraps, const RayDepth& rays,
                MotionNodes& out) {
  NodeFinder(images, maps, wraps, rays, out).run();
}

void take_columns(const MotionNodes& nodes, const MotionSamples& samples, MotionColumns& out) {
  const std::size_t count = nodes.count();
  out.rate.assign(6 * samples.nodes, 0.0F);
  out.light.assign(6 * samples.nodes, 0.0F);
  out.counts.assign(samples.nodes, 0.0F);
  out.by_node.assign(2 * kColumnLanes * samples.nodes, 0.0F);
  for (std::size_t s = 0; s < samples.node.size(); ++s) {
    const auto n = static_cast<std::size_t>(samples.node[s]);
    if (nodes.quality[n] != NodeQuality::kFits) continue;
    out.counts[s] = 1;
    for (std::size_t k = 0; k < 6; ++k) {
      out.rate[k * samples.nodes + s] = nodes.rate[k * count + n];
      out.light[k * samples.nodes + s] = nodes.light[k * count + n];
      out.by_node[2 * kColumnLanes * s + k] = nodes.rate[k * count + n];
      out.by_node[2 * kColumnLanes * s + kColumnLanes + k] = nodes.light[k * count + n];
    }
  }
}

}  // namespace enamel::pipeline
