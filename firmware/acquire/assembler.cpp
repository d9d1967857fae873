#include "firmware/acquire/assembler.hpp"

#include <algorithm>
#include <utility>

#include "firmware/acquire/frame_digest.hpp"
#include "firmware/acquire/frame_pixels.hpp"

namespace enamel::fw {
namespace {

using proto::DropReason;

constexpr std::size_t kMaxWaiting = 3;
constexpr int kMemoryFrames = 32;
constexpr int kScatter = 5;  // distance of two stamps, in median absolute deviations of one

Nanoseconds exposure_of(const CameraFrame& frame) { return Nanoseconds{std::int64_t{frame.exposure_us} * 1000}; }

}  // namespace

AssemblerConfig AssemblerConfig::for_mode(const CameraMode& mode, Nanoseconds stamp_delay, Nanoseconds max_spread) {
  AssemblerConfig c;
  c.width = mode.width;
  c.height = mode.height;
  c.bit_depth = mode.bit_depth;
  c.frame_period = mode.frame_period;
  const Nanoseconds scatter = std::max(Nanoseconds{0}, max_spread - kUsualStampSpread) * kScatter;
  c.tol_period = std::min(mode.frame_period / 40 + scatter, mode.frame_period / 5);
  c.tol_association = mode.frame_period / 5;
  c.burst_timeout = mode.frame_period * 6;
  c.margin = std::min(Nanoseconds{25'000}, Nanoseconds{std::int64_t{mode.exposure_us} * 1000 / 50});
  c.stamp_delay = stamp_delay;
  c.dark_max_dn = 12.0 * static_cast<double>(1U << static_cast<unsigned>(std::max(0, mode.bit_depth - 8)));
  return c;
}

BurstAssembler::BurstAssembler(const AssemblerConfig& config)
    : config_(config), log_(config.frame_period * kMemoryFrames) {}

void BurstAssembler::edges_known_until(DeviceTime t) {
  log_.advance(t);
  while (!waiting_.empty() && (waiting_.front().t_sensor - config_.stamp_delay <= t || waiting_.size() > kMaxWaiting)) {
    CameraFrame frame = std::move(waiting_.front());
    waiting_.pop_front();
    judge(std::move(frame));
  }
  if (waiting_.empty()) open_gates(t - config_.burst_timeout);  // no frames at all: the burst still ends
  if (current_ && t - current_->t_gate > config_.burst_timeout) fault(DropReason::kTimeout);
}

void BurstAssembler::abort(DropReason reason) {
  while (const auto gate = log_.take_gate(DeviceTime::max())) {
    give_up(reason);
    current_.emplace();
    current_->index = gate->burst_index;
  }
  fault(reason);
}

void BurstAssembler::camera_restarted(Nanoseconds stamp_delay) {
  config_.stamp_delay = stamp_delay;
  waiting_.clear();
  previous_.reset();
  armed_ = false;
}

std::vector<BurstOutcome> BurstAssembler::take_outcomes() { return std::exchange(outcomes_, {}); }

void BurstAssembler::push_edge(const Edge& edge) {
  if (edge.kind == EdgeKind::kGate) ++begun_;
  log_.push(edge);
}

void BurstAssembler::finish(BurstOutcome outcome) {
  outcomes_.push_back(std::move(outcome));
  current_.reset();
  ++ended_;
}

void BurstAssembler::give_up(DropReason reason) {
  if (current_) finish(GivenUpBurst{current_->index, reason});
}

/// Without a burst under way nothing is lost, but the next one needs a new sentinel first, and is given up for this
/// reason if it gets none.
void BurstAssembler::fault(DropReason reason) {
  give_up(reason);
  armed_ = false;
  not_armed_because_ = reason;
}

void BurstAssembler::open_gates(DeviceTime until) {
  while (const auto gate = log_.take_gate(until)) {
    give_up(DropReason::kTimeout);
    current_.emplace();
    current_->index = gate->burst_index;
    current_->t_gate = gate->t;
  }
}

void BurstAssembler::check_sequence(const CameraFrame& frame) {
  // Exposures begin at the frame rate, whatever their length.
  const DeviceTime begin = frame.t_sensor - exposure_of(frame);
  if (previous_) {
    const Nanoseconds distance = begin - previous_->begin;
    if (frame.sensor_seq != previous_->seq + 1) {
      fault(DropReason::kSeqGap);
    } else if (std::chrono::abs(distance - config_.frame_period) > config_.tol_period) {
      fault(DropReason::kPeriod);
    }
  }
  previous_ = FrameSeen{frame.sensor_seq, begin};
}

tl::expected<BurstAssembler::Window, DropReason> BurstAssembler::window_of(const CameraFrame& frame) {
  const Nanoseconds exposure = exposure_of(frame);
  const DeviceTime expected = frame.t_sensor - exposure - config_.stamp_delay;
  Strobe* const strobe = log_.nearest_strobe(expected);
  if (strobe == nullptr || std::chrono::abs(strobe->t - expected) > config_.tol_association) {
    return tl::unexpected(DropReason::kNoStrobe);
  }
  if (strobe->used) return tl::unexpected(DropReason::kDupStrobe);
  strobe->used = true;
  return Window{strobe->t, strobe->t + exposure};
}

void BurstAssembler::judge(CameraFrame frame) {
  if (frame.status != FrameStatus::kSuccess) {
    previous_.reset();
    previous_hash_.reset();
    return fault(DropReason::kFrameStatus);
  }
  if (frame.width != config_.width || frame.height != config_.height || frame.bit_depth != config_.bit_depth ||
      !is_whole(frame)) {
    return fault(DropReason::kEncode);
  }
  check_sequence(frame);
  const auto window = window_of(frame);
  const FrameDigest look = digest(frame);
  const bool repeated = look.hash && look.hash == previous_hash_;
  previous_hash_ = look.hash;
  if (!window) return fault(window.error());
  open_gates(window->begin);
  if (repeated) return fault(DropReason::kDupContent);
  const std::vector<Pattern> patterns = log_.patterns_in(window->begin, window->end);
  if (patterns.size() > 1) return fault(DropReason::kMulti);
  if (log_.lit_across(window->begin)) return fault(DropReason::kPartial);
  if (patterns.empty()) return judge_dark(look.mean_dn);
  judge_lit(std::move(frame), patterns.front(), *window);
}

void BurstAssembler::judge_dark(double mean_dn) {
  if (mean_dn >= config_.dark_max_dn) {
    ++dark_leaks_;
    return fault(DropReason::kDarkLeak);
  }
  dark_leaks_ = 0;
  // Inside a burst a dark frame is out of order; before its first pattern the projector is merely late.
  if (current_ && current_->next > 0) fault(DropReason::kOrder);
  armed_ = true;
  ambient_dn_ = mean_dn;
}

void BurstAssembler::judge_lit(CameraFrame frame, const Pattern& pattern, const Window& window) {
  const bool sentinel = std::exchange(armed_, false);
  if (!current_) {
    not_armed_because_ = DropReason::kOrder;
    return;  // rest of a burst that was given up
  }
  if (current_->next == 0 && !sentinel) return fault(not_armed_because_);
  if (pattern.rise < window.begin + config_.margin || !pattern.fall || *pattern.fall > window.end - config_.margin) {
    return fault(DropReason::kPartial);
  }
  if (pattern.index != current_->next) return fault(DropReason::kOrder);
  auto& frames = current_->burst.frames;
  const auto k = static_cast<std::size_t>(current_->next);
  if (k > 0) {
    if (frame.exposure_us != frames[0].frame.exposure_us) return fault(DropReason::kSettling);
    const Nanoseconds distance = window.begin - frames[k - 1].t_strobe;
    if (std::chrono::abs(distance - config_.frame_period) > config_.tol_period) return fault(DropReason::kNoStrobe);
  }
  frames[k] = LitFrame{std::move(frame), window.begin, pattern.rise, *pattern.fall};
  not_armed_because_ = DropReason::kOrder;
  if (++current_->next < static_cast<int>(frames.size())) return;
  current_->burst.burst_index = current_->index;
  current_->burst.ambient_dn = ambient_dn_;
  finish(std::move(current_->burst));
}

}  // namespace enamel::fw
