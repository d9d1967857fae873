#include "pipeline/decode/mode_m/micro_gates.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "pipeline/decode/mode_m/chosen.hpp"
#include "pipeline/decode/mode_m/micro_spans.hpp"
#include "pipeline/decode/phase/median.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {
namespace {

using Matrix = Eigen::Matrix<double, kOddColumns, kOddColumns>;
using Vector = Eigen::Matrix<double, kOddColumns, 1>;

constexpr int kRowStep = 8;            ///< layout: stride over rows
constexpr float kHalfPi = 1.5707964F;  ///< derived: erf(x/sqrt 2) is x/sqrt(x^2 + pi/2) to 0.06
static_assert(kOddSpread.size() == kOddColumns);

struct Equations {
  Matrix left = Matrix::Zero();
  Vector right = Vector::Zero();
};

class Blocks {
 public:
  /// sums: of one block, as add_micro_odd_row lays them out.
  void add(const double* sums) {
    Equations block;
    for (Eigen::Index i = 0; i < block.left.rows(); ++i) {
      for (Eigen::Index j = i; j < block.left.cols(); ++j) block.left(i, j) = block.left(j, i) = *sums++;
      block.right[i] = *sums++;
    }
    asked_ += sums[0], explained_ += sums[1];
    all_.left += block.left, all_.right += block.right;
    judge(block, kOddInformed_rad);
  }

  /// Of blocks that all say too little, their sum; over a whole image light excuses nothing.
  MicroOdd result() {
    if (odd_.empty()) {
      judge(all_, std::numeric_limits<double>::infinity());
      unrest_.clear();
    }
    const double explained = asked_ > 0 ? explained_ / asked_ : 1;  // all codes may be saturated
    return {median(code_shift_), median(odd_), explained, median(unrest_)};
  }

 private:
  void judge(const Equations& block, double informed_rad) {
    Matrix left = block.left;
    left.diagonal() += Vector(kOddSpread.data()).cwiseAbs2().cwiseInverse();
    const auto factors = left.ldlt();
    const Matrix covariance = factors.solve(Matrix::Identity());
    if (!(std::max(covariance(0, 0), covariance(1, 1)) < informed_rad * informed_rad)) return;
    const Vector x = factors.solve(block.right);
    code_shift_.push_back(static_cast<float>(x[0]));
    odd_.push_back(static_cast<float>(std::hypot(x[0], x[1])));
    unrest_.push_back(static_cast<float>(std::abs(x[3])));
  }

  std::vector<float> code_shift_, odd_, unrest_;
  Equations all_;
  double asked_ = 0, explained_ = 0;
};

}  // namespace

MicroOdd find_micro_odd(const MicroBurst& burst, const MicroMotion& motion, float max_residual) {
  const Map<std::int16_t>& wraps = burst.wraps;
  std::vector<double> sums;
  std::vector<float> columns;
  BlockSums<kMicroOddSums> block_sums(wraps.width(), wraps.height(), kOddBlock_px, columns, sums);
  CodeRows rows(motion, burst.maps, &wraps);
  rows.expect(burst.code, burst.third_rad);
  for (int v = 0; v < wraps.height(); v += kRowStep)
    add_micro_odd_row(rows.at(v), burst.noise, max_residual, block_sums.width(), block_sums.columns_of(v));
  block_sums.finish();
  Blocks blocks;
  for (std::size_t at = 0; at < sums.size(); at += kMicroOddSums) blocks.add(&sums[at]);
  return blocks.result();
}

double direction_share(const PhaseMaps& maps, const Carrier& carrier) {
  double follows = 0, expected = 0;
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  for (std::size_t at = 0; at < maps.phase_rad.size(); at += width) {
    const float* __restrict p = &maps.phase_rad[at], * __restrict c = carrier.phase_mid_rad + at;
    const float* __restrict sigma = &maps.sigma_rad[at];
    const PixelReject* __restrict reject = &maps.reject[at];
    float row_follows = 0, row_expected = 0;
    for (std::size_t u = 0; u + 1 < width; ++u) {
      const bool valid = (reject[u] == PixelReject::kNone) & (reject[u + 1] == PixelReject::kNone);
      const float step = c[u + 1] - c[u], noise2 = sigma[u] * sigma[u] + sigma[u + 1] * sigma[u + 1];
      const float kept = std::abs(step) / root(step * step + kHalfPi * noise2 + 1e-12F);  // of a sign, by noise
      row_follows += select(valid, select(wrap_once(p[u + 1] - p[u]) * step > 0, kept, -kept), 0);
      row_expected += select(valid, kept * kept, 0);
    }
    follows += static_cast<double>(row_follows);
    expected += static_cast<double>(row_expected);
  }
  return expected > 0 ? 0.5 + 0.5 * std::clamp(follows / expected, -1.0, 1.0) : 0;
}

}  // namespace enamel::pipeline
