// Light that changes by itself within a burst: a lamp that swings with the mains, or is dimmed. It adds to frame k an
// amount o_k of its own, which turns the three-frame solution into C + c, S + s and the fourth frame into something
// else than they predict. A common amount does no harm. What shows it:
//   |(C, S)|/A = B/A + (c cos phi + s sin phi)/A        B/A belongs to matter and focus and knows no fringes; motion
//                                                       and harmonics make ripple of other periods there
//   fourth frame - its prediction = d + (slope over C) c + (slope over S) s + ...
// Lamp and projector shine on the same surface, so what the lamp adds is taken as a share of A that changes slowly over
// the image, q = (c, s, d)/A; or as a veil that does, where that explains more: a surface that turns away from the
// projector need not turn away from the lamp. Blocks of the image give q each, by least squares. One lamp has one
// course over the frames and one map over the image,
//   q(x, y) = f L(x, y),        |f| = 1,
// a product, as which the blocks' q are explained. A burst without such light is told by the blocks' own spread.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "pipeline/decode/phase/block_fit.hpp"
#include "pipeline/decode/phase/grid_rows.hpp"
#include "pipeline/decode/phase/noise_model.hpp"
#include "pipeline/decode/phase/phase.hpp"

namespace enamel::pipeline {

struct LightChangeConfig {
  /// chosen: by judgement, two fringes wide at least; below, the ripple is not told from a slope of B/A.
  int block_px = 64;
  int row_step = 8;  ///< layout: of the rows that are asked
  /// derived: chi squared of three unknowns that noise alone exceeds in one burst of a thousand.
  double least_proof = 16.3;
  /// chosen: by judgement, a micrometre at the middle of the depth range. Less is left alone.
  double least_rad = 3e-3;
  /// chosen: on rendered sets. Of a motion eps, more: what it leaves of light that changes as surfaces turn.
  double least_of_motion = 0.05;
  std::size_t least_blocks = 6;  ///< chosen: by judgement. Fewer do not tell their own spread.
};

/// What changing light is a slowly changing multiple of.
enum class LampLight { kAsSurface, kEven };

/// A row's pixels at mid-burst, as far as motion is known. In DN where not said otherwise.
struct LightRow {
  float* light;                          ///< A above black
  float *cosine, *sine;                  ///< B cos phi, B sin phi of three frames
  float* rest;                           ///< fourth frame less its prediction
  float *rest_by_cosine, *rest_by_sine;  ///< change of rest per DN of c and of s
  float* rest_by_gain;                   ///< and per unit of what blur leaves of the fourth frame's fringe
  float* weight;                         ///< one over the variance of B; 0: not asked
  float* rest_weight;                    ///< one over the variance of rest; 0: not known
};

/// layout: DN. What shares of an even light are shares of: as A is at a usual place, so that both are alike in size.
inline constexpr float kEvenLight_dn = 50;

/// What a share is taken of; light: A above black.
[[nodiscard]] inline float lamp_base_dn(LampLight of, float light) noexcept {
  return of == LampLight::kEven ? kEvenLight_dn : light;
}

/// One burst's; keeps its memory between bursts. Not thread-safe.
class LightChange {
 public:
  void start(int width, int height, const LightChangeConfig& config, LampLight of);
  /// To be written before each take_row, which takes it; all 0 after start.
  [[nodiscard]] LightRow row() noexcept;
  /// Every row_step-th row, in order.
  void take_row(int v);
  /// After the last row. Whether light changed by more than noise, and than what the blocks disagree by, explains.
  /// motion_rad: of the burst, a frame interval.
  [[nodiscard]] bool find(float motion_rad);

  /// c, s, d over what they are a multiple of; valid until the next start.
  [[nodiscard]] Grid share(std::size_t of) const noexcept;
  [[nodiscard]] LampLight light_of() const noexcept { return of_; }
  /// Mean size of q over B/A: about the amplitude of the phase's ripple, rad.
  [[nodiscard]] double ripple_rad() const noexcept { return ripple_rad_; }
  /// Chi squared of the mean q about none.
  [[nodiscard]] double proof() const noexcept { return proof_; }
  /// Minus the log likelihood of the blocks' pixels, to compare one LampLight with the other.
  [[nodiscard]] double misfit() const noexcept { return misfit_; }

 private:
  /// layout: q, gain of the fourth frame, two slopes of B/A, its ripple twice a fringe, itself.
  static constexpr std::size_t kUnknowns = 9;
  using Fit = BlockFit<kUnknowns>;

  /// What a block says; weight: inverse of its covariance.
  struct Block {
    std::size_t node = 0;
    double x = 0, y = 0;  ///< of its middle, -1 ... 1
    Eigen::Vector3d q;
    Eigen::Matrix3d weight;
    double contrast = 0;  ///< B/A
  };

  void fill_stretch();
  void solve_blocks();
  [[nodiscard]] bool prove(Eigen::Vector3d& mean);
  void explain(Eigen::Vector3d course);
  void make_map(const Eigen::Vector3d& course);

  LightChangeConfig config_;
  LampLight of_ = LampLight::kAsSurface;
  std::size_t width_ = 0;
  int columns_ = 0, rows_ = 0;
  std::vector<float> column_sums_, stretch_, row_;
  std::vector<double> sums_;
  std::optional<BlockSums<Fit::kSums>> blocks_of_image_;
  std::vector<Block> blocks_;
  std::array<std::vector<float>, 3> nodes_;
  double ripple_rad_ = 0, proof_ = 0, misfit_ = 0, motion_rad_ = 0;
};

}  // namespace enamel::pipeline
