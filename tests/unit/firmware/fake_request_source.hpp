// A FAKE of libcamera's requests: completes them when a test says so, with any fault. No driver in reach can be made to
// lose, repeat or reorder frames, nor has one control delays.
#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <utility>
#include <vector>

#include "firmware/device/linux/camera/request_source.hpp"

namespace enamel::fw::test {

class FakeRequestSource final : public RequestSource {
 public:
  static constexpr std::int64_t kPeriod = 4'004'000;

  explicit FakeRequestSource(int slots = 8, StreamFormat format = {16, 2, 8, PixelFormat::kRaw8, 20})
      : format_(format), memory_(static_cast<std::size_t>(slots)) {
    for (auto& m : memory_) m.resize(format_.stride * static_cast<std::size_t>(format_.height));
  }

  [[nodiscard]] const StreamFormat& format() const override { return format_; }
  [[nodiscard]] int slots() const override { return static_cast<int>(memory_.size()); }
  [[nodiscard]] std::span<const std::uint8_t> memory(int slot) const override {
    return memory_[static_cast<std::size_t>(slot)];
  }
  [[nodiscard]] Result<void> start(const CameraControls& controls, CompletionSink& sink) override {
    ++starts;
    if (refuse_start) return fail(ErrorCode::kCamera, "refused");
    now_ = controls;
    sink_ = &sink;
    sequence_ = 0;
    if (on_start) on_start(*this);
    return {};
  }
  void stop() noexcept override {
    ++stops;
    Completion cancelled;
    cancelled.status = FrameStatus::kCancelled;
    for (const int slot : std::exchange(queued_, {})) {
      cancelled.slot = slot;
      sink_->completed(cancelled);
    }
  }
  [[nodiscard]] Result<void> queue(int slot, const std::optional<CameraControls>& change) override {
    if (refuse_queue) return fail(ErrorCode::kCamera, "refused");
    queued_.push_back(slot);
    if (change) changes.push_back(*change);
    if (change) now_ = *change;
    if (on_queue) on_queue(*this);
    return {};
  }

  /// Completes the oldest request. False when none is queued.
  bool deliver(const std::function<void(Completion&)>& harm = {}) {
    if (queued_.empty()) return false;
    Completion done;
    done.slot = queued_.front();
    queued_.pop_front();
    done.sequence = sequence_++;
    done.stamp_ns = base_ns + std::int64_t{done.sequence} * kPeriod;
    done.exposure_us = now_.exposure_us;
    auto& pixels = memory_[static_cast<std::size_t>(done.slot)];
    if (content) {
      content(pixels);
    } else {
      std::fill(pixels.begin(), pixels.end(), static_cast<std::uint8_t>(done.sequence));
    }
    if (harm) harm(done);
    if (held_now_) {
      held_.push_back(done);
    } else {
      sink_->completed(done);
    }
    return true;
  }
  /// As deliver(), but told only at release_held().
  void hold_next(const std::function<void(Completion&)>& harm) {
    held_now_ = true;
    deliver(harm);
    held_now_ = false;
  }
  int release_held() {
    const auto held = std::exchange(held_, {});
    for (const Completion& done : held) sink_->completed(done);
    return static_cast<int>(held.size());
  }
  void complete_again(const Completion& done) { sink_->completed(done); }
  void skip_sequence() { ++sequence_; }
  void unplug() { sink_->disconnected(); }
  [[nodiscard]] std::size_t queued() const { return queued_.size(); }

  int starts = 0;
  int stops = 0;
  bool refuse_start = false;
  bool refuse_queue = false;
  std::int64_t base_ns = 1'000'000'000;
  std::vector<CameraControls> changes;
  std::function<void(std::span<std::uint8_t>)> content;  ///< instead of the sequence number everywhere
  std::function<void(FakeRequestSource&)> on_start;
  std::function<void(FakeRequestSource&)> on_queue;

 private:
  StreamFormat format_;
  std::vector<std::vector<std::uint8_t>> memory_;
  std::deque<int> queued_;
  std::vector<Completion> held_;
  bool held_now_ = false;
  CompletionSink* sink_ = nullptr;
  CameraControls now_;
  std::uint32_t sequence_ = 0;
};

}  // namespace enamel::fw::test
