#include "pipeline/register/icp/accumulate.hpp"

namespace enamel::pipeline {
namespace {

constexpr std::size_t kBlock = 64;
using Indices = std::array<std::int32_t, kBlock>;

/// A rigid motion in float, spelt out for loops over one array a coordinate.
struct Motion {
  float r00, r01, r02, r10, r11, r12, r20, r21, r22, tx, ty, tz;
  explicit Motion(const Pose& T)
      : r00(static_cast<float>(T(0, 0))),
        r01(static_cast<float>(T(0, 1))),
        r02(static_cast<float>(T(0, 2))),
        r10(static_cast<float>(T(1, 0))),
        r11(static_cast<float>(T(1, 1))),
        r12(static_cast<float>(T(1, 2))),
        r20(static_cast<float>(T(2, 0))),
        r21(static_cast<float>(T(2, 1))),
        r22(static_cast<float>(T(2, 2))),
        tx(static_cast<float>(T(0, 3))),
        ty(static_cast<float>(T(1, 3))),
        tz(static_cast<float>(T(2, 3))) {}
  [[nodiscard]] Vec3f turn(float x, float y, float z) const {
    return {r00 * x + r01 * y + r02 * z, r10 * x + r11 * y + r12 * z, r20 * x + r21 * y + r22 * z};
  }
  [[nodiscard]] Vec3f operator()(float x, float y, float z) const {
    return {r00 * x + r01 * y + r02 * z + tx, r10 * x + r11 * y + r12 * z + ty, r20 * x + r21 * y + r22 * z + tz};
  }
};

/// Reference pixel of each sample of the block, or -1. No branches: the compiler works four at a time.
void associate(const Alignment& of, std::size_t first, std::size_t n, const Motion& to_view, Indices& out) {
  const SampleSet& s = of.samples;
  const ViewCamera& camera = of.camera;
  const Reference& reference = of.reference;
  const float scale = reference.pixels_per_camera_pixel();
  const auto width = static_cast<float>(reference.width());
  const auto height = static_cast<float>(reference.height());
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = first + k;
    const Vec3f p = to_view(s.x[i], s.y[i], s.z[i]);
    const Vec2f px = camera.project(p);
    const float u = px.x() * scale + 0.5F;
    const float v = px.y() * scale + 0.5F;
    const bool inside = (p.z() > 1.0F) & (u >= 0.0F) & (v >= 0.0F) & (u < width) & (v < height);
    const int iu = static_cast<int>(inside ? u : 0.0F);
    const int iv = static_cast<int>(inside ? v : 0.0F);
    out[k] = inside ? iv * reference.width() + iu : -1;
  }
}

/// Sums of w a a^T for a = (J, e, 1) in float over one block, then into double. Columns 0..3 of the lower rows are the
/// transpose of what is kept.
class BlockSums {
 public:
  void add(const Eigen::Array4f& low, const Eigen::Array4f& high, float w) {
    for (Eigen::Index i = 0; i < 4; ++i) {
      const float wi = w * low[i];
      upper_.col(i) += wi * low;
      cross_.col(i) += wi * high;
      lower_.col(i) += (w * high[i]) * high;
    }
  }
  void flush(NormalSystem& out) {
    sums_.topLeftCorner<4, 4>() += upper_.matrix().cast<double>();
    sums_.topRightCorner<4, 4>() += cross_.matrix().transpose().cast<double>();
    sums_.bottomRightCorner<4, 4>() += lower_.matrix().cast<double>();
    upper_.setZero();
    cross_.setZero();
    lower_.setZero();
    const Eigen::Matrix<double, 8, 8> full = sums_.selfadjointView<Eigen::Upper>();
    out.H = full.topLeftCorner<6, 6>();
    out.g = full.block<6, 1>(0, 6);
    out.weight = full(7, 7);
  }

 private:
  Eigen::Array44f upper_ = Eigen::Array44f::Zero();
  Eigen::Array44f cross_ = Eigen::Array44f::Zero();
  Eigen::Array44f lower_ = Eigen::Array44f::Zero();
  Eigen::Matrix<double, 8, 8> sums_ = Eigen::Matrix<double, 8, 8>::Zero();
};

}  // namespace

AlignPass accumulate(const Alignment& of, const Pose& T_model_cam, const MatchGate& gate, const RobustKernel& kernel) {
  const SampleSet& samples = of.samples;
  const Reference& reference = of.reference;
  const Motion to_model(T_model_cam);
  const Motion to_view(reference.T_model_cam().inverse() * T_model_cam);
  const Vec3f axis = reference.T_model_cam().linear().col(2).cast<float>();
  const Vec3f centre = (T_model_cam * samples.centroid).cast<float>();
  const auto inv_rho = static_cast<float>(1 / of.rho_mm);
  AlignPass pass;
  BlockSums sums;
  Indices indices;
  for (std::size_t first = 0; first < samples.size(); first += kBlock) {
    const std::size_t n = std::min(kBlock, samples.size() - first);
    associate(of, first, n, to_view, indices);
    float weight = 0;
    float weighted_e2 = 0;
    for (std::size_t k = 0; k < n; ++k) {
      if (indices[k] < 0) continue;
      const Reference::Pixel& pixel = reference.pixel(static_cast<std::size_t>(indices[k]));
      if (!(pixel.point.x() == pixel.point.x())) continue;
      const std::size_t i = first + k;
      const Vec3f p = to_model(samples.x[i], samples.y[i], samples.z[i]);
      const Vec3f d = p - pixel.point;
      const Vec3f own = to_model.turn(samples.nx[i], samples.ny[i], samples.nz[i]);
      const float cosine = pixel.normal.dot(own);
      // Rusinkiewicz 2019: between the two normals the distance is exact on any constant curvature. By the pixel's
      // alone a sample half a pixel beside it is off by its sagitta, to the same side everywhere.
      const float e = 0.5F * (pixel.normal + own).dot(d);
      if (!(std::abs(e) < gate.distance_mm) || d.squaredNorm() > gate.distance3d_mm * gate.distance3d_mm ||
          cosine < gate.min_cos) {
        pass.contradictions += axis.dot(d) > gate.hidden_mm ? 0U : 1U;
        continue;
      }
      const Vec3f lever = (p - centre).cross(pixel.normal) * inv_rho;
      const float w = samples.weights[i];
      sums.add({lever.x(), lever.y(), lever.z(), pixel.normal.x()}, {pixel.normal.y(), pixel.normal.z(), e, 1.0F},
               w * kernel.weight(e));
      pass.residuals.add(std::abs(e));
      weight += w;
      weighted_e2 += w * e * e;
      ++pass.matches;
    }
    sums.flush(pass.system);
    pass.weight += static_cast<double>(weight);
    pass.weighted_e2 += static_cast<double>(weighted_e2);
  }
  return pass;
}

}  // namespace enamel::pipeline
