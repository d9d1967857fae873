#include "pipeline/decode/mode_m/micro_gates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "pipeline/decode/mode_m/chosen.hpp"
#include "pipeline/decode/mode_m/micro_spans.hpp"
#include "pipeline/decode/phase/block_fit.hpp"
#include "pipeline/decode/phase/median.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kRowStep = 8;  ///< layout: stride over rows

constexpr float kHalfOfOdd = 0.66F;  ///< derived: half of an odd frame's delta over what it shows by, on average
constexpr double kProvenSigmas = 4;  ///< derived: noise alone gets there once in 30 000 bursts

/// The two unknowns from `first` on are none.
constexpr std::array<double, kOddColumns> without(std::size_t first) {
  auto spread = kOddSpread;
  spread[first] = spread[first + 1] = 1e-6;
  return spread;
}

class Blocks {
 public:
  using Fit = BlockFit<kOddColumns>;

  /// sums: of one block, as add_micro_odd_row lays them out.
  void add(const double* sums) {
    const Fit block(sums);
    asked_ += sums[kMicroOddSums - 1], explained_ += block.count();
    all_ += block;
    judge(block, kOddInformed_rad);
  }

  /// Of blocks that all say too little, their sum; over a whole image light excuses nothing.
  MicroOdd result() {
    if (odd_.empty()) {
      judge(all_, std::numeric_limits<double>::infinity());
      unrest_.clear();
    }
    const double explained = asked_ > 0 ? explained_ / asked_ : 1;  // all codes may be saturated
    return {median(code_shift_), median(odd_), exposure_step(), share(), explained, median(unrest_)};
  }

 private:
  void judge(const Fit& block, double informed_rad) {
    const auto known = block.solve(without(2));
    if (!(std::max(known.sigma(0), known.sigma(1)) < informed_rad)) return;
    const auto lit = block.solve(without(0));
    code_shift_.push_back(static_cast<float>(known.x[0]));
    odd_.push_back(static_cast<float>(std::hypot(known.x[0], known.x[1])));
    alone_light_.push_back(static_cast<float>(lit.x[2])), skew_light_.push_back(static_cast<float>(lit.x[3]));
    unrest_.push_back(static_cast<float>(std::abs(known.x[5])));
    told_ += block.told_by_first<kOddUnknowns>(kOddSpread);
  }

  /// A frame's exposure is the same in all blocks.
  [[nodiscard]] float exposure_step() { return kHalfOfOdd * std::hypot(median(alone_light_), median(skew_light_)); }

  [[nodiscard]] double share() const {
    const double by_noise = std::sqrt(2.0 * kOddUnknowns * static_cast<double>(odd_.size()));  // of chi squared
    if (!(told_.first > kProvenSigmas * by_noise)) return 0;
    return told_.first / (told_.first + std::max(told_.left, 0.0));
  }

  std::vector<float> code_shift_, odd_, alone_light_, skew_light_, unrest_;
  Fit all_;
  Fit::Told told_;
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

}  // namespace enamel::pipeline
