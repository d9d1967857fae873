// The one place on the host where bursts are dropped on purpose: a bounded queue between the network and the stage
// graph that lets the oldest go when the pipeline is slower than the probe. Every item dropped is handed back to the
// caller, so that it can be counted and noted in the recording.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace enamel::host {

enum class GatePolicy {
  kLossless,    ///< push waits for room: replay
  kShedOldest,  ///< push never waits: live
};

/// Thread-safe for one pusher and one popper. A mutex, not a ring: the pusher takes the oldest item out again, which
/// the producer of an SPSC ring may not do, and the network thread is allowed to wait here.
template <class T>
class IngressGate {
 public:
  IngressGate(std::size_t capacity, GatePolicy policy) : capacity_(capacity), policy_(policy) {}

  /// Returns the item that had to go, if any. After close() the item itself comes back.
  [[nodiscard]] std::optional<T> push(T item) {
    std::unique_lock lock(mutex_);
    if (policy_ == GatePolicy::kLossless) {
      room_.wait(lock, [&] { return queue_.size() < capacity_ || closed_; });
    }
    if (closed_) return item;
    std::optional<T> dropped;
    if (queue_.size() >= capacity_) {
      dropped = std::move(queue_.front());
      queue_.pop_front();
    }
    queue_.push_back(std::move(item));
    lock.unlock();
    filled_.notify_one();
    return dropped;
  }

  /// Waits for an item; nullopt when the gate is closed and empty.
  [[nodiscard]] std::optional<T> pop() {
    std::unique_lock lock(mutex_);
    filled_.wait(lock, [&] { return !queue_.empty() || closed_; });
    return take(lock);
  }

  /// Nullopt at once when nothing is there.
  [[nodiscard]] std::optional<T> try_pop() {
    std::unique_lock lock(mutex_);
    return take(lock);
  }

  /// No more items; what is inside can still be popped.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    filled_.notify_all();
    room_.notify_all();
  }

  /// Closed and empty: nothing will come any more.
  [[nodiscard]] bool drained() const {
    const std::lock_guard lock(mutex_);
    return closed_ && queue_.empty();
  }

  [[nodiscard]] std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return queue_.size();
  }

 private:
  std::optional<T> take(std::unique_lock<std::mutex>& lock) {
    if (queue_.empty()) return std::nullopt;
    std::optional<T> item(std::move(queue_.front()));
    queue_.pop_front();
    lock.unlock();
    room_.notify_one();
    return item;
  }

  const std::size_t capacity_;
  const GatePolicy policy_;
  mutable std::mutex mutex_;
  std::condition_variable filled_, room_;
  std::deque<T> queue_;
  bool closed_ = false;
};

}  // namespace enamel::host
