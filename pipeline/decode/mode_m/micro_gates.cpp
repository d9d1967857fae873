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

constexpr int kRowStep = 8;  ///< layout: stride over rows
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
  std::size_t seen = 0, follows = 0;
  const auto width = static_cast<std::size_t>(maps.phase_rad.width());
  for (std::size_t at = 0; at < maps.phase_rad.size(); at += width) {
    const float* __restrict p = &maps.phase_rad[at], * __restrict c = carrier.phase_mid_rad + at;
    const PixelReject* __restrict reject = &maps.reject[at];
    unsigned row_seen = 0, row_follows = 0;
    for (std::size_t u = 0; u + 1 < width; ++u) {
      const unsigned valid = static_cast<unsigned>(reject[u] == PixelReject::kNone) &
                             static_cast<unsigned>(reject[u + 1] == PixelReject::kNone);
      row_seen += valid;
      row_follows += valid & static_cast<unsigned>(wrap_once(p[u + 1] - p[u]) * (c[u + 1] - c[u]) > 0);
    }
    seen += row_seen;
    follows += row_follows;
  }
  return seen > 0 ? static_cast<double>(follows) / static_cast<double>(seen) : 0;
}

}  // namespace enamel::pipeline
