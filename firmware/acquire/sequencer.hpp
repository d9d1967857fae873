// Decides when the next burst may be armed. Pure.
#pragma once

#include <cstdint>
#include <optional>

namespace enamel::fw {

struct SequencerConfig {
  int settle_frames = 3;  ///< good frames after a start or a change of exposure, gain or light before the first burst
};

class Sequencer {
 public:
  explicit Sequencer(const SequencerConfig& config = {}) : config_(config) {}

  /// Camera (re)started; `limit`: end by itself after so many bursts.
  void start(std::optional<std::uint64_t> limit = std::nullopt) {
    settle_left_ = config_.settle_frames;
    armed_ = false;
    draining_ = false;
    left_ = limit;
  }
  /// Camera restarted in the middle: what is left to do stays.
  void settle() {
    settle_left_ = config_.settle_frames;
    armed_ = false;
  }
  void on_frame(bool good) {
    if (good && settle_left_ > 0) --settle_left_;
  }
  /// No new burst is armed; the one under way may end.
  void drain() { draining_ = true; }
  void on_armed() { armed_ = true; }
  void on_begun(std::uint64_t n) {
    if (n == 0) return;
    armed_ = false;
    if (left_) *left_ = *left_ > n ? *left_ - n : 0;
  }
  [[nodiscard]] bool want_arm() const noexcept { return settle_left_ == 0 && !armed_ && !draining_ && left_ != 0U; }
  [[nodiscard]] bool draining() const noexcept { return draining_; }
  /// All bursts asked for have begun.
  [[nodiscard]] bool limit_reached() const noexcept { return left_ == 0U; }

 private:
  SequencerConfig config_;
  int settle_left_ = 0;
  bool armed_ = false;
  bool draining_ = false;
  std::optional<std::uint64_t> left_;
};

}  // namespace enamel::fw
