#include "calib/guide/pose_gatherer.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "calib/model/pattern.hpp"

namespace enamel::calib {
namespace {

// Two frames of a board at rest differ by noise alone. A shift of 0.3 px changes the edges of the dots, one to
// two per cent of the image, by a fifth of their step.
constexpr double kMotionSigmas = 6;
constexpr double kMovedShare = 0.001;

void add_to(std::array<Map<float>, 4>& sum, const std::array<Map<float>, 4>& frames) {
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (sum[k].empty()) sum[k] = Map<float>(frames[k].width(), frames[k].height());
    for (std::size_t i = 0; i < sum[k].size(); ++i) sum[k][i] += frames[k][i];
  }
}

Map<float> mean_of(const Map<float>& a, const Map<float>& b, float share) {
  Map<float> out(a.width(), a.height());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = share * (a[i] + b[i]);
  return out;
}

std::vector<FringeLevel> levels_of(std::vector<std::array<Map<float>, 4>>& sets, std::size_t first,
                                   const std::vector<int>& cycles, float share) {
  std::vector<FringeLevel> levels;
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    FringeLevel level{.cycles = cycles[i], .frames = std::move(sets[first + i])};
    for (Map<float>& frame : level.frames)
      for (float& value : frame.pixels()) value *= share;
    levels.push_back(std::move(level));
  }
  return levels;
}

}  // namespace

Result<MultiSets> multi_sets(const Rig& rig) {
  if (is_burst_set(rig.patterns))
    return fail(ErrorCode::kPatternSet, "the probe shows its scanning patterns, not a calibration set (mode multi)");
  const auto json = nlohmann::json::parse(rig.text, nullptr, /*allow_exceptions=*/false);
  const auto patterns = json.is_object() ? json.value("patterns", nlohmann::json::object()) : nlohmann::json::object();
  const auto cycles = patterns.value("cycles", nlohmann::json::array());
  MultiSets sets;
  for (const auto& c : cycles) {
    const int last = sets.cycles.empty() ? 0 : sets.cycles.back();
    if (!c.is_number_integer() || c.get<int>() <= last || c.get<int>() > 10'000) {
      return fail(ErrorCode::kPatternSet, "patterns.cycles must be rising whole numbers");
    }
    sets.cycles.push_back(c.get<int>());
  }
  if (sets.cycles.empty() || sets.cycles.front() != 1)
    return fail(ErrorCode::kPatternSet, "patterns.cycles must begin with 1");
  return sets;
}

GatherEvent PoseGatherer::add(int set, const std::array<Map<float>, 4>& frames) {
  if (set != static_cast<int>(sweep_.size())) {
    if (!sweep_.empty()) ++broken_;
    sweep_.clear();
    if (set != 0) return GatherEvent::kNothing;
  }
  sweep_.push_back(frames);
  if (static_cast<int>(sweep_.size()) < sets_.count()) return GatherEvent::kNothing;
  const GatherEvent event = end_of_sweep();
  sweep_.clear();
  return event;
}

PoseGatherer::Look PoseGatherer::look() const {
  Look out{sweep_.front()[0], sweep_.back()[0]};
  for (std::size_t i = 0; i < out.even.size(); ++i) {
    for (std::size_t k = 1; k < 4; ++k) out.even[i] += sweep_.back()[k][i];
    out.even[i] *= 0.25F;
  }
  return out;
}

bool PoseGatherer::is_changed(const Map<float>& now, const Map<float>& before, int averaged) const {
  const PixelNoise noise = noise_.of_mean(averaged);
  std::size_t changed = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const double a = static_cast<double>(now[i]), b = static_cast<double>(before[i]);
    const double variance = 2 * noise.variance(0.5 * (a + b));
    changed += (a - b) * (a - b) > kMotionSigmas * kMotionSigmas * variance ? 1U : 0U;
  }
  return static_cast<double>(changed) > kMovedShare * static_cast<double>(now.size());
}

bool PoseGatherer::moved(const Look& now) const {
  return is_changed(now.white, reference_->white, 1) || is_changed(now.even, reference_->even, 4);
}

GatherEvent PoseGatherer::end_of_sweep() {
  GatherEvent event = GatherEvent::kNothing;
  Look now = look();
  if (reference_ && moved(now)) {
    if (!is_taken_ && gathered_ > 1) event = GatherEvent::kMoved;
    reference_.reset();
  }
  if (!reference_) {
    reference_ = std::move(now);
    sum_.assign(sweep_.size(), {});
    gathered_ = 0;
    is_taken_ = false;
  }
  if (is_taken_) return event;
  for (std::size_t s = 0; s < sweep_.size(); ++s) add_to(sum_[s], sweep_[s]);
  return ++gathered_ == sweeps_ ? GatherEvent::kPose : event;
}

PoseFrames PoseGatherer::take() {
  const float share = 1.0F / static_cast<float>(gathered_);
  PoseFrames frames;
  frames.white = mean_of(sum_[0][0], sum_[0][2], 0.5F * share);
  frames.black = mean_of(sum_[0][1], sum_[0][3], 0.5F * share);
  frames.along_u = levels_of(sum_, 1, sets_.cycles, share);
  frames.along_v = levels_of(sum_, 1 + sets_.cycles.size(), sets_.cycles, share);
  sum_.clear();
  is_taken_ = true;
  return frames;
}

}  // namespace enamel::calib
