#include "pipeline/decode/phase/light_change.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "pipeline/decode/phase/chosen.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {
namespace {

/// layout: columns of a pixel's two equations, which BlockFit solves; what they say, and their weight.
enum Column : std::size_t { kCosine, kSine, kRest, kGain, kAlong, kAcross, kCosine2, kSine2, kLevel, kSaid, kWeight };
constexpr std::size_t kColumns = kWeight + 1;  ///< layout: rows of a stretch
constexpr std::array<Column, 8> kOfFringe = {kCosine, kSine, kAlong, kAcross, kCosine2, kSine2, kLevel, kSaid};
constexpr std::array<Column, 5> kOfRest = {kCosine, kSine, kRest, kGain, kSaid};

/// Where BlockFit keeps the product of columns i <= j.
constexpr std::size_t sum_of(std::size_t i, std::size_t j) { return i * (kSaid + 1) - i * (i - 1) / 2 + (j - i); }
constexpr std::size_t kCount = sum_of(kSaid, kSaid) + 1;
static_assert(kCount + 1 == BlockFit<kSaid>::kSums);

constexpr std::size_t kRowValues = 9;  // layout: of LightRow

using Terms = Eigen::Matrix<double, 6, 1>;

Terms terms_at(double x, double y) { return (Terms() << 1, x, y, x * x, x * y, y * y).finished(); }

void add_products(std::span<const Column> columns, const float* stretch, std::size_t width, float* sums) {
  const float* __restrict weight = stretch + kWeight * width;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t j = i; j < columns.size(); ++j) {
      const float* __restrict a = stretch + columns[i] * width, * __restrict b = stretch + columns[j] * width;
      float* __restrict sum = sums + sum_of(columns[i], columns[j]) * width;
      ENAMEL_INDEPENDENT  // a and b may be one
          for (std::size_t u = 0; u < width; ++u) sum[u] += weight[u] * a[u] * b[u];
    }
  }
  float* __restrict count = sums + kCount * width;
  for (std::size_t u = 0; u < width; ++u) count[u] += select(weight[u] > 0, 1, 0);
}

}  // namespace

void LightChange::start(int width, int height, const LightChangeConfig& config, LampLight of) {
  config_ = config, of_ = of;
  width_ = static_cast<std::size_t>(width);
  columns_ = (width + config.block_px - 1) / config.block_px, rows_ = (height + config.block_px - 1) / config.block_px;
  stretch_.resize(kColumns * width_);
  row_.assign(kRowValues * width_, 0.0F);
  blocks_of_image_.emplace(width, height, config.block_px, column_sums_, sums_);
}

LightRow LightChange::row() noexcept {
  const auto at = [this](std::size_t k) { return row_.data() + k * width_; };
  return {at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7), at(8)};
}

void LightChange::take_row(int v) {
  const LightRow row = this->row();
  float* sums = blocks_of_image_->columns_of(v);
  const auto size = static_cast<float>(config_.block_px);
  add_fringe(row, (static_cast<float>(v % config_.block_px) + 0.5F) / size - 0.5F, sums);
  add_rest(row, sums);
}

/// B/A of a pixel.
void LightChange::add_fringe(const LightRow& row, float across, float* sums) {
  const auto to = [&](Column k) { return stretch_.data() + k * width_; };
  float* __restrict cosine = to(kCosine), * __restrict sine = to(kSine), * __restrict along = to(kAlong);
  float* __restrict cosine2 = to(kCosine2), * __restrict sine2 = to(kSine2), * __restrict said = to(kSaid);
  float* __restrict weight = to(kWeight);
  const auto size = static_cast<float>(config_.block_px);
  for (std::size_t u = 0; u < width_; ++u) {
    const bool asked = row.weight[u] > 0;
    const float light = select(asked, row.light[u], 1);
    const float x = select(asked, row.cosine[u], 1), y = select(asked, row.sine[u], 0);
    const float b = root(x * x + y * y + 1e-6F), c = x / b, s = y / b;
    const float base = lamp_base_dn(of_, light) / light;
    cosine[u] = c * base, sine[u] = s * base, cosine2[u] = c * c - s * s, sine2[u] = 2 * c * s;
    along[u] = (static_cast<float>(static_cast<int>(u) % config_.block_px) + 0.5F) / size - 0.5F;
    said[u] = b / light;
    weight[u] = select(asked, row.weight[u] * light * light, 0);
  }
  std::fill_n(to(kAcross), width_, across);
  std::fill_n(to(kLevel), width_, 1.0F);
  add_products(kOfFringe, stretch_.data(), width_, sums);
}

/// What the fourth frame of a pixel is off its prediction by, over A.
void LightChange::add_rest(const LightRow& row, float* sums) {
  const auto to = [&](Column k) { return stretch_.data() + k * width_; };
  float* __restrict cosine = to(kCosine), * __restrict sine = to(kSine), * __restrict gain = to(kGain);
  float* __restrict said = to(kSaid), * __restrict weight = to(kWeight), * __restrict rest = to(kRest);
  for (std::size_t u = 0; u < width_; ++u) {
    const bool asked = row.rest_weight[u] > 0;
    const float light = select(asked, row.light[u], 1), inverse = 1 / light;
    const float base = lamp_base_dn(of_, light) * inverse;
    cosine[u] = select(asked, row.rest_by_cosine[u] * base, 0), sine[u] = select(asked, row.rest_by_sine[u] * base, 0);
    rest[u] = base;
    gain[u] = select(asked, row.rest_by_gain[u] * inverse, 0);
    said[u] = select(asked, row.rest[u] * inverse, 0);
    weight[u] = select(asked, row.rest_weight[u] * light * light, 0);
  }
  add_products(kOfRest, stretch_.data(), width_, sums);
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
