#include "pipeline/algo/phase/frame_errors.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
namespace {

constexpr int kTerms = 4;
using Row = Eigen::Matrix<double, kTerms, 1>;

/// Sums of one block, from which its own mean is taken out before blocks are added up ("within" estimator): B/A of the
/// block then drops out, whatever it is, and part of a fringe at the block's border does no harm.
struct BlockSums {
  Eigen::Matrix4d xx = Eigen::Matrix4d::Zero();
  Row xy = Row::Zero(), x = Row::Zero();
  double y = 0, n = 0;
};

/// Ripple of the mean of four frames, of C and S.
struct MeanRipple {
  double of_c = 0, of_s = 0;
};

/// A above black: code_dn is I0+I2-I1-I3, mean_dn the mean of frames 0 and 2.
double mean_of(const PhaseMaps& m, std::size_t i, double black_dn, MeanRipple r) {
  return static_cast<double>(m.mean_dn[i]) - 0.25 * static_cast<double>(m.code_dn[i]) - black_dn -
         r.of_c * static_cast<double>(m.cosine_dn[i]) - r.of_s * static_cast<double>(m.sine_dn[i]);
}

struct Solved {
  Row theta = Row::Zero();
  double pixels = 0;
};

class Estimator {
 public:
  Estimator(std::span<const CellSpan> spans, const PolarityMaps& polarity, double black_dn, int block_px)
      : spans_(spans), polarity_(polarity), black_dn_(black_dn), block_px_(block_px) {}

  MeanRipple ripple;

  template <class Visit>
  void pixels(const PhaseMaps& m, Visit visit) const {
    for (const CellSpan& s : spans_) {
      for (int u = s.begin; u < s.end; ++u) {
        const std::size_t i = m.phase_rad.index(u, s.row);
        if (polarity_.weight[i] < 0.999F || m.reject[i] != PixelReject::kNone || std::isnan(m.code_dn[i])) continue;
        if (mean_of(m, i, black_dn_, ripple) > 1) visit(i, u, s.row);
      }
    }
  }

  /// r_a, r_c, r_s.
  [[nodiscard]] Eigen::Vector3d closure(const PhaseMaps& m) const {
    Eigen::Matrix3d xx = Eigen::Matrix3d::Zero();
    Eigen::Vector3d xy = Eigen::Vector3d::Zero();
    pixels(m, [&](std::size_t i, int, int) {
      const Eigen::Vector3d x(mean_of(m, i, black_dn_, ripple), static_cast<double>(m.cosine_dn[i]),
                              static_cast<double>(m.sine_dn[i]));
      xx += x * x.transpose();
      xy += x * static_cast<double>(m.code_dn[i]);
    });
    const auto factors = xx.ldlt();
    if (factors.info() != Eigen::Success || !factors.isPositive()) return Eigen::Vector3d::Zero();
    const Eigen::Vector3d r = factors.solve(xy);
    return r.allFinite() ? r : Eigen::Vector3d::Zero();
  }

  [[nodiscard]] Solved solve(const PhaseMaps& m) const {
    const int columns = (m.phase_rad.width() + block_px_ - 1) / block_px_;
    const int rows = (m.phase_rad.height() + block_px_ - 1) / block_px_;
    std::vector<BlockSums> blocks(static_cast<std::size_t>(columns * rows));
    pixels(m, [&](std::size_t i, int u, int v) {
      const auto b = static_cast<double>(m.modulation_dn[i]);
      const double c = static_cast<double>(m.cosine_dn[i]) / b, s = static_cast<double>(m.sine_dn[i]) / b;
      const double y = b / mean_of(m, i, black_dn_, ripple);
      const Row x(c, s, y * (c * c - s * s), y * 2 * c * s);
      BlockSums& block = blocks[static_cast<std::size_t>((v / block_px_) * columns + u / block_px_)];
      block.xx += x * x.transpose();
      block.xy += x * y;
      block.x += x;
      block.y += y;
      block.n += 1;
    });
    Eigen::Matrix4d xx = Eigen::Matrix4d::Zero();
    Row xy = Row::Zero();
    Solved out;
    for (const BlockSums& b : blocks) {
      if (b.n < 2) continue;
      xx += b.xx - b.x * b.x.transpose() / b.n;
      xy += b.xy - b.x * (b.y / b.n);
      out.pixels += b.n;
    }
    const auto factors = xx.ldlt();
    if (factors.info() == Eigen::Success && factors.isPositive()) out.theta = factors.solve(xy);
    if (!out.theta.allFinite()) out.theta.setZero();
    return out;
  }

 private:
  std::span<const CellSpan> spans_;
  const PolarityMaps& polarity_;
  double black_dn_;
  int block_px_;
};

/// rho, by default 1 as long as the frames' brightness differs by little.
double follow_of(double squeeze, double closure_of_mean) {
  constexpr double kPrior = 0.005 * 0.005;
  return (4 * squeeze * closure_of_mean + kPrior) / (closure_of_mean * closure_of_mean + kPrior);
}

void remove(const Row& t, double black_dn, MeanRipple ripple, std::size_t i, PhaseMaps& m) {
  const double a = mean_of(m, i, black_dn, ripple);
  const double c = static_cast<double>(m.cosine_dn[i]) - t[0] * a, s = static_cast<double>(m.sine_dn[i]) - t[1] * a;
  const auto cosine = static_cast<float>(c - t[2] * c - t[3] * s), sine = static_cast<float>(s - t[3] * c + t[2] * s);
  m.cosine_dn[i] = cosine;
  m.sine_dn[i] = sine;
  m.modulation_dn[i] = root(cosine * cosine + sine * sine + 1e-6F);
  m.phase_rad[i] += wrap_once(atan2_poly(sine, cosine) - m.phase_rad[i]);
}

}  // namespace

FrameErrors correct_frame_errors(std::span<const CellSpan> spans, const PolarityMaps& polarity, double black_dn,
                                 const FrameErrorConfig& config, PhaseMaps& maps) {
  Estimator estimator(spans, polarity, black_dn, config.block_px);
  const Eigen::Vector3d r = estimator.closure(maps);
  FrameErrors found;
  for (int round = 0; round < config.rounds; ++round) {
    const Solved step = estimator.solve(maps);
    if (step.pixels < config.min_pixels) return found;
    estimator.pixels(maps, [&](std::size_t i, int, int) { remove(step.theta, black_dn, estimator.ripple, i, maps); });
    found.offset_cos += step.theta[0];
    found.offset_sin += step.theta[1];
    found.squeeze += step.theta[2];
    found.shear += step.theta[3];
    found.follow = follow_of(found.squeeze, r[0]);
    found.pixels = step.pixels;
    if (config.rippled_mean)
      estimator.ripple = {found.follow * found.offset_cos - 0.25 * r[1], found.follow * found.offset_sin + 0.25 * r[2]};
  }
  return found;
}

}  // namespace enamel::algo
