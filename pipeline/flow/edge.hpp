// A connection between two ports: a bounded queue with a policy for the case that it is full.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "pipeline/flow/item.hpp"
#include "protocol/base/latest_slot.hpp"
#include "protocol/base/metrics.hpp"
#include "protocol/base/spsc_ring.hpp"

namespace enamel::flow {

class Stage;

enum class OnFull : std::uint8_t {
  kBlock,       ///< lossless: the producing stage is not run until there is room
  kKeepLatest,  ///< one slot; the newest item replaces the one not yet taken, which is counted as dropped
};

struct EdgeSpec {
  std::size_t capacity = 2;  ///< items, kBlock only
  OnFull on_full = OnFull::kBlock;
};

/// Producer writes pushed, dropped, depth, blocked_ns; consumer writes popped, awaited_ns.
struct EdgeStats {
  Counter pushed;
  Counter popped;
  Counter dropped;
  Gauge depth;         ///< at each push; its max is the high-water mark
  Counter awaited_ns;  ///< time that the consumer had nothing to do because this edge was empty
  Counter blocked_ns;  ///< time that the producer could not run because this edge was full
};

/// The part of an edge that does not depend on the payload.
class EdgeBase {
 public:
  EdgeBase(Stage& from, std::string from_port, Stage& to, std::string to_port, EdgeSpec spec, std::size_t delay)
      : from_(from),
        to_(to),
        from_port_(std::move(from_port)),
        to_port_(std::move(to_port)),
        spec_(spec),
        delay_(delay) {}
  virtual ~EdgeBase() = default;
  EdgeBase(const EdgeBase&) = delete;
  EdgeBase& operator=(const EdgeBase&) = delete;

  [[nodiscard]] Stage& from() const noexcept { return from_; }
  [[nodiscard]] Stage& to() const noexcept { return to_; }
  [[nodiscard]] const std::string& from_port() const noexcept { return from_port_; }
  [[nodiscard]] const std::string& to_port() const noexcept { return to_port_; }
  [[nodiscard]] const EdgeSpec& spec() const noexcept { return spec_; }
  [[nodiscard]] std::size_t delay() const noexcept { return delay_; }  ///< > 0: feedback
  [[nodiscard]] const EdgeStats& stats() const noexcept { return stats_; }
  void note_awaited(std::uint64_t ns) noexcept { stats_.awaited_ns.add(ns); }  ///< consumer
  void note_blocked(std::uint64_t ns) noexcept { stats_.blocked_ns.add(ns); }  ///< producer

  /// Producer: nothing will be pushed any more.
  void close() noexcept { closed_.store(true, std::memory_order_release); }

 protected:
  [[nodiscard]] bool closed() const noexcept { return closed_.load(std::memory_order_acquire); }
  EdgeStats stats_;

 private:
  Stage& from_;
  Stage& to_;
  std::string from_port_;
  std::string to_port_;
  EdgeSpec spec_;
  std::size_t delay_;
  std::atomic<bool> closed_{false};
};

/// One producing and one consuming stage; each side is touched only by the worker that has claimed that stage.
template <class T>
class Edge final : public EdgeBase {
 public:
  Edge(Stage& from, std::string from_port, Stage& to, std::string to_port, EdgeSpec spec, std::size_t delay)
      : EdgeBase(from, std::move(from_port), to, std::move(to_port), spec, delay) {
    if (spec.on_full == OnFull::kBlock) ring_ = std::make_unique<SpscRing<Item<T>>>(spec.capacity);
  }

  /// Producer.
  [[nodiscard]] bool writable() noexcept { return !ring_ || ring_->writable(); }
  /// Producer, while writable().
  void push(Item<T> item) {
    stats_.pushed.add();
    if (ring_) {
      ENAMEL_CHECK(ring_->push(std::move(item)), "the executor runs a stage only when its outputs have room");
      stats_.depth.set(static_cast<std::int64_t>(ring_->size()));
    } else {
      if (slot_.put(std::move(item))) stats_.dropped.add();
      stats_.depth.set(1);
    }
  }

  /// Consumer. Oldest item in place, null when there is none now.
  [[nodiscard]] Item<T>* front() {
    if (ring_) return ring_->front();
    if (!held_) held_ = slot_.take();
    return held_ ? &*held_ : nullptr;
  }
  /// Consumer, after front() gave an item.
  void pop() {
    stats_.popped.add();
    if (ring_) {
      ring_->pop();
    } else {
      held_.reset();
    }
  }
  /// Consumer: nothing left and nothing will come. The flag is read first: an item pushed before it is then visible.
  [[nodiscard]] bool ended() { return closed() && front() == nullptr; }

 private:
  std::unique_ptr<SpscRing<Item<T>>> ring_;
  LatestSlot<Item<T>> slot_;
  std::optional<Item<T>> held_;
};

}  // namespace enamel::flow
