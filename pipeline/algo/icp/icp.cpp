#include "pipeline/algo/icp/icp.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace enamel::algo {
namespace {

/// Median of |e| by counting: no order of points can change it.
class ResidualHistogram {
 public:
  void add(float abs_e) {
    ++bins_[std::min(static_cast<std::size_t>(abs_e * kPerMm), bins_.size() - 1)];
    ++count_;
  }
  [[nodiscard]] double median_mm() const {
    std::size_t seen = 0;
    for (std::size_t i = 0; i < bins_.size(); ++i) {
      seen += bins_[i];
      if (2 * seen >= count_) return (static_cast<double>(i) + 0.5) / static_cast<double>(kPerMm);
    }
    return 0;
  }

 private:
  static constexpr float kPerMm = 1000.0F;
  std::array<std::uint32_t, 1024> bins_{};
  std::uint32_t count_ = 0;
};

struct Kernel {
  bool welsch = false;
  float inv_scale = 1;  ///< 1 / (tuning constant * robust standard deviation), 1/mm
  [[nodiscard]] float weight(float e) const {
    const float r = std::abs(e) * inv_scale;
    if (welsch) return std::exp(-r * r);
    return r <= 1.0F ? 1.0F : 1.0F / r;
  }
};

struct Pass {
  NormalSystem system;
  ResidualHistogram residuals;
  double weight = 0;  ///< of matches, without the kernel
  double weighted_e2 = 0;
  std::size_t matches = 0;
  std::size_t contradictions = 0;
  [[nodiscard]] double rms() const { return weight > 0 ? std::sqrt(weighted_e2 / weight) : 0; }
};

struct Frame {
  Eigen::Matrix3f R_model, R_view;
  Vec3f t_model, t_view;
  Vec3f centre;
  Frame(const Pose& T_model_cam, const Pose& T_model_view, const Vec3d& centroid) {
    const Pose T_view_cam = T_model_view.inverse() * T_model_cam;
    R_model = T_model_cam.linear().cast<float>();
    t_model = T_model_cam.translation().cast<float>();
    R_view = T_view_cam.linear().cast<float>();
    t_view = T_view_cam.translation().cast<float>();
    centre = (T_model_cam * centroid).cast<float>();
  }
};

struct Gate {
  float distance, distance3d2, min_cos, inv_rho;
};

/// Index of the reference pixel that sample p falls on, or -1.
std::ptrdiff_t reference_index(const Vec3f& p_view, const Reference& reference, const ViewCamera& camera) {
  if (!(p_view.z() > 1.0F)) return -1;
  const Vec2f px = camera.project(p_view) * reference.pixels_per_camera_pixel();
  const int u = static_cast<int>(std::floor(px.x() + 0.5F));
  const int v = static_cast<int>(std::floor(px.y() + 0.5F));
  if (u < 0 || v < 0 || u >= reference.width() || v >= reference.height()) return -1;
  return static_cast<std::ptrdiff_t>(v) * reference.width() + u;
}

void accumulate(const SampleSet& samples, const Reference& reference, const ViewCamera& camera, const Frame& f,
                const Gate& gate, const Kernel& kernel, Pass& pass) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec3f& p = samples.points[i];
    const std::ptrdiff_t index = reference_index(f.R_view * p + f.t_view, reference, camera);
    if (index < 0) continue;
    const Vec3f& m = reference.point(static_cast<std::size_t>(index));
    if (!std::isfinite(m.x())) continue;
    const Vec3f& n = reference.normal(static_cast<std::size_t>(index));
    const Vec3f x = f.R_model * p + f.t_model;
    const Vec3f d = x - m;
    const float e = n.dot(d);
    if (!(std::abs(e) < gate.distance) || d.squaredNorm() > gate.distance3d2 ||
        n.dot(f.R_model * samples.normals[i]) < gate.min_cos) {
      ++pass.contradictions;
      continue;
    }
    Eigen::Matrix<float, 6, 1> J;
    J.head<3>() = (x - f.centre).cross(n) * gate.inv_rho;
    J.tail<3>() = n;
    const float w = samples.weights[i];
    pass.system.add(J, e, w * kernel.weight(e));
    pass.residuals.add(std::abs(e));
    pass.weight += static_cast<double>(w);
    pass.weighted_e2 += static_cast<double>(w) * static_cast<double>(e) * static_cast<double>(e);
    ++pass.matches;
  }
}

Gate make_gate(const IcpLevel& level, double rho_mm) {
  // The nearest pixel of the reference lies beside the point, not only above it: allow for its pitch.
  const double reach = level.gate_mm + 0.1;
  return {static_cast<float>(level.gate_mm), static_cast<float>(reach * reach),
          static_cast<float>(std::cos(level.max_normal_deg * std::numbers::pi / 180)), static_cast<float>(1 / rho_mm)};
}

Kernel make_kernel(const IcpConfig& config, bool finest, double scale_mm) {
  const double tuning = finest ? config.welsch_scale : config.huber_scale;
  return {finest, static_cast<float>(1 / (tuning * std::max(scale_mm, config.samples.sigma_floor_mm)))};
}

bool small(const Vector6& x, double rho_mm, double translation_mm, double rotation_rad) {
  return x.tail<3>().norm() < translation_mm && x.head<3>().norm() < rotation_rad * rho_mm;
}

}  // namespace

PatchPyramid make_pyramid(const SurfacePatch& patch, const IcpConfig& config) {
  PatchPyramid out;
  for (std::size_t l = 0; l < out.levels.size(); ++l) {
    out.levels[l] = sample_patch(patch, config.levels[l].stride_px, config.samples);
  }
  return out;
}

IcpResult align(const PatchPyramid& patch, const Reference& reference, const ViewCamera& camera, const Pose& start,
                const Pose& prior, const IcpConfig& config) {
  IcpResult out;
  out.T_model_cam = start;
  if (reference.empty()) return out;
  for (std::size_t l = 0; l < config.levels.size(); ++l) {
    const IcpLevel& level = config.levels[l];
    const SampleSet& samples = patch.levels[l];
    const Gate gate = make_gate(level, config.rho_mm);
    double scale = level.gate_mm / 3;
    double last_rms = 0;
    for (int k = 0; k < level.max_iterations; ++k) {
      const Frame frame(out.T_model_cam, reference.T_model_cam(), samples.centroid);
      Pass pass;
      accumulate(samples, reference, camera, frame, gate, make_kernel(config, l == 2, scale), pass);
      if (pass.matches < config.min_matches / (l == 0 ? 4 : 1)) return out;
      const Vec3d centre = out.T_model_cam * samples.centroid;
      const Vector6 to_prior = motion_between(out.T_model_cam, prior, centre, config.rho_mm);
      const Solution step = solve(pass.system, to_prior, config.prior);
      out.T_model_cam = apply_motion(step.x, centre, config.rho_mm, out.T_model_cam);
      ++out.iterations;
      out.rms_mm = pass.rms();
      out.overlap = static_cast<double>(pass.matches) / static_cast<double>(samples.size());
      out.consistency = static_cast<double>(pass.matches) / static_cast<double>(pass.matches + pass.contradictions);
      out.weak_directions = step.weak;
      out.eigenvalues = step.eigenvalues;
      scale = 1.4826 * pass.residuals.median_mm();
      const bool settled = std::abs(out.rms_mm - last_rms) < config.rms_change * out.rms_mm &&
                           small(step.x, config.rho_mm, config.small_step_mm, config.small_step_mm / config.rho_mm);
      if (settled || small(step.x, config.rho_mm, config.end_translation_mm, config.end_rotation_rad)) break;
      last_rms = out.rms_mm;
    }
  }
  out.converged = true;
  return out;
}

}  // namespace enamel::algo
