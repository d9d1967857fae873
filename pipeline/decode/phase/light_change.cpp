#include "pipeline/decode/phase/light_change.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/decode/phase/chosen.hpp"
#include "pipeline/decode/phase/light_rows.hpp"

namespace enamel::pipeline {
namespace {

constexpr std::size_t kRowValues = 9;  // layout: of LightRow

using Terms = Eigen::Matrix<double, 6, 1>;

Terms terms_at(double x, double y) { return (Terms() << 1, x, y, x * x, x * y, y * y).finished(); }

}  // namespace

void LightChange::start(int width, int height, const LightChangeConfig& config, LampLight of) {
  config_ = config, of_ = of;
  width_ = static_cast<std::size_t>(width);
  columns_ = (width + config.block_px - 1) / config.block_px, rows_ = (height + config.block_px - 1) / config.block_px;
  fill_stretch();
  row_.assign(kRowValues * width_, 0.0F);
  blocks_of_image_.emplace(width, height, config.block_px, column_sums_, sums_);
}

LightRow LightChange::row() noexcept {
  const auto at = [this](std::size_t k) { return row_.data() + k * width_; };
  return {at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7), at(8)};
}

/// What does not change from row to row.
void LightChange::fill_stretch() {
  stretch_.resize(kLightColumns * width_);
  const auto size = static_cast<float>(config_.block_px);
  float *along = stretch_.data() + kAlong * width_, *level = stretch_.data() + kLevel * width_;
  for (std::size_t u = 0; u < width_; ++u)
    along[u] = (static_cast<float>(static_cast<int>(u) % config_.block_px) + 0.5F) / size - 0.5F;
  std::fill_n(level, width_, 1.0F);
}

void LightChange::take_row(int v) {
  const LightRow row = this->row();
  float* sums = blocks_of_image_->columns_of(v);
  const auto size = static_cast<float>(config_.block_px);
  const float across = (static_cast<float>(v % config_.block_px) + 0.5F) / size - 0.5F;
  std::fill_n(stretch_.data() + kAcross * width_, width_, across);
  add_lamp_fringe_row(row, of_, width_, stretch_.data(), sums);
  add_lamp_rest_row(row, of_, width_, stretch_.data(), sums);
}

void LightChange::solve_blocks() {
  blocks_.clear();
  misfit_ = 0;
  for (int j = 0; j < rows_; ++j) {
    for (int i = 0; i < columns_; ++i) {
      const auto node = static_cast<std::size_t>(j * columns_ + i);
      const Fit fit(&sums_[node * Fit::kSums]);
      if (fit.count() < kLeastLightPixels) continue;
      const Fit::Known known = fit.solve(kLightSpread);
      const double contrast = known.x[kLevel];
      if (!(contrast > kLeastLightContrast)) continue;
      const double left = 1 + fit.told_by_first<1>(kLightSpread).left / fit.count();
      misfit_ += 0.5 * fit.count() * std::log(std::max(left, 0.1));
      const Eigen::Matrix3d covariance = std::max(1.0, left) * known.covariance.topLeftCorner<3, 3>();
      blocks_.push_back({node, 2 * (i + 0.5) / columns_ - 1, 2 * (j + 0.5) / rows_ - 1, known.x.head<3>(),
                         covariance.inverse(), contrast});
    }
  }
}

/// The mean q, and whether it is more than noise and what blocks disagree by.
bool LightChange::prove(Eigen::Vector3d& mean) {
  proof_ = ripple_rad_ = 0;
  if (blocks_.size() < config_.least_blocks) return false;
  Eigen::Matrix3d weight = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Block& b : blocks_) weight += b.weight, sum += b.weight * b.q;
  mean = weight.ldlt().solve(sum);
  double spread = 0, ripple = 0;
  for (const Block& b : blocks_) {
    const Eigen::Vector3d off = b.q - mean;
    spread += off.dot(b.weight * off);
    ripple += mean.norm() / b.contrast;
  }
  const auto count = static_cast<double>(blocks_.size());
  proof_ = mean.dot(weight * mean) / std::max(1.0, spread / (3 * (count - 1)));
  ripple_rad_ = ripple / count;
  return proof_ > config_.least_proof && ripple_rad_ > config_.least_rad + config_.least_of_motion * motion_rad_;
}

bool LightChange::find(float motion_rad) {
  motion_rad_ = static_cast<double>(std::abs(motion_rad));
  blocks_of_image_->finish();
  solve_blocks();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  if (!prove(mean)) return false;
  explain(mean);
  return true;
}

/// Course and map in turn, each by least squares with the other given.
void LightChange::explain(Eigen::Vector3d course) {
  for (int round = 0; round < kCourseRounds; ++round) {
    course.normalize();
    make_map(course);
    Eigen::Matrix3d left = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Block& b : blocks_) {
      const auto level = static_cast<double>(nodes_[0][b.node]);
      left += level * level * b.weight, right += level * b.weight * b.q;
    }
    course = left.ldlt().solve(right);
  }
  course.normalize();
  make_map(course);
  for (std::size_t k = nodes_.size(); k-- > 0;) {
    nodes_[k].resize(nodes_[0].size());
    const auto share = static_cast<float>(course[static_cast<Eigen::Index>(k)]);
    for (std::size_t n = 0; n < nodes_[k].size(); ++n) nodes_[k][n] = share * nodes_[0][n];
  }
}

/// L at all nodes, into the first of nodes_: a quadratic, and what blocks tell beside it as far as it is not noise.
void LightChange::make_map(const Eigen::Vector3d& course) {
  std::vector<double> levels(blocks_.size()), precision(blocks_.size());
  double sum = 0, total = 0;
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const Block& b = blocks_[k];
    precision[k] = course.dot(b.weight * course);
    levels[k] = course.dot(b.weight * b.q) / precision[k];
    sum += precision[k] * levels[k], total += precision[k];
  }
  const double mean = sum / total, ridge = 1 / (kMapBend * kMapBend * mean * mean + 1e-12);
  Eigen::Matrix<double, 6, 6> left = Eigen::Matrix<double, 6, 6>::Zero();
  Terms right = Terms::Zero();
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const Terms t = terms_at(blocks_[k].x, blocks_[k].y);
    left += precision[k] * t * t.transpose(), right += precision[k] * levels[k] * t;
  }
  left.diagonal().tail<5>().array() += ridge;
  const Terms map = left.ldlt().solve(right);
  double beyond = 0;
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const double off = levels[k] - map.dot(terms_at(blocks_[k].x, blocks_[k].y));
    beyond += precision[k] * (off * off - 1 / precision[k]);
  }
  const double variance = std::max(0.0, beyond / total);  // of what is no quadratic
  nodes_[0].resize(static_cast<std::size_t>(columns_ * rows_));
  for (int j = 0; j < rows_; ++j) {
    for (int i = 0; i < columns_; ++i)
      nodes_[0][static_cast<std::size_t>(j * columns_ + i)] =
          static_cast<float>(map.dot(terms_at(2 * (i + 0.5) / columns_ - 1, 2 * (j + 0.5) / rows_ - 1)));
  }
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    float& node = nodes_[0][blocks_[k].node];
    const double share = variance * precision[k] / (variance * precision[k] + 1);
    node += static_cast<float>(share * (levels[k] - static_cast<double>(node)));
  }
}

Grid LightChange::share(std::size_t of) const noexcept {
  return {nodes_[of].data(), columns_, rows_, config_.block_px};
}

}  // namespace enamel::pipeline
