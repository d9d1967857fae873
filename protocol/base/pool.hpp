// Fixed pool of reusable objects behind counted references: no allocation after construction.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "protocol/base/cache_line.hpp"
#include "protocol/base/check.hpp"

namespace enamel {

/// Bounded queue of indices that any thread may push and pop (Vyukov's MPMC queue): sequence numbers per cell, so a
/// stale index can never be mistaken for a fresh one (no ABA). A push finds room by construction; a pop may find none.
class IndexQueue {
 public:
  explicit IndexQueue(std::size_t capacity);
  IndexQueue(const IndexQueue&) = delete;
  IndexQueue& operator=(const IndexQueue&) = delete;

  /// False when full.
  [[nodiscard]] bool push(std::uint32_t index) noexcept;
  /// False when empty.
  [[nodiscard]] bool pop(std::uint32_t& index) noexcept;

 private:
  struct Cell {
    std::atomic<std::size_t> sequence;
    std::uint32_t index;
  };
  std::vector<Cell> cells_;
  std::size_t mask_;
  alignas(kCacheLine) std::atomic<std::size_t> head_{0};
  alignas(kCacheLine) std::atomic<std::size_t> tail_{0};
};

namespace detail {

template <class T>
struct PoolCore;

template <class T>
struct PoolNode {
  explicit PoolNode(T&& v) : value(std::move(v)) {}
  T value;
  std::atomic<std::uint32_t> references{0};
  std::uint32_t index = 0;
  PoolCore<T>* core = nullptr;
};

template <class T>
struct PoolCore {
  explicit PoolCore(std::size_t n) : free(n) { nodes.reserve(n); }
  std::vector<std::unique_ptr<PoolNode<T>>> nodes;
  IndexQueue free;
  std::atomic<std::size_t> in_use{0};
  std::atomic<std::size_t> peak{0};
};

}  // namespace detail

template <class T>
class Pool;

/// Counted handle on a pooled object: Ref<T> while it is filled (one owner), Ref<const T> once published and shared.
/// Copies may live on different threads; one handle itself belongs to one thread. The pool must outlive its handles.
template <class T>
class Ref {
  using Node = detail::PoolNode<std::remove_const_t<T>>;

 public:
  Ref() = default;
  Ref(const Ref& o) noexcept : node_(o.node_) {
    if (node_ != nullptr) node_->references.fetch_add(1, std::memory_order_relaxed);
  }
  Ref(Ref&& o) noexcept : node_(std::exchange(o.node_, nullptr)) {}
  /// Ref<T> to Ref<const T>: publishing.
  Ref(Ref<std::remove_const_t<T>>&& o) noexcept requires std::is_const_v<T> : node_(std::exchange(o.node_, nullptr)) {}
  Ref& operator=(Ref o) noexcept {
    std::swap(node_, o.node_);
    return *this;
  }
  ~Ref() { release(); }

  [[nodiscard]] explicit operator bool() const noexcept { return node_ != nullptr; }
  [[nodiscard]] T& operator*() const noexcept { return node_->value; }
  [[nodiscard]] T* operator->() const noexcept { return &node_->value; }
  [[nodiscard]] T* get() const noexcept { return node_ != nullptr ? &node_->value : nullptr; }

 private:
  template <class U>
  friend class Ref;
  friend class Pool<std::remove_const_t<T>>;
  explicit Ref(Node* node) noexcept : node_(node) {}

  void release() noexcept {
    if (node_ == nullptr) return;
    // acq_rel: everything the other holders read or wrote happens before the next user fills the object again.
    if (node_->references.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
    ENAMEL_CHECK(node_->core->in_use.fetch_sub(1, std::memory_order_relaxed) > 0,
                 "more objects returned than the pool owns");
    // Every index is out once, so there is room; the queue says full only while an acquire() is between claiming its
    // cell and clearing it.
    while (!node_->core->free.push(node_->index)) std::this_thread::yield();
  }

  Node* node_ = nullptr;
};

/// Owns `capacity` objects made by `make`. Objects come back as they were left: clear what must not be seen again.
/// acquire() and the release of handles are safe from any thread.
template <class T>
class Pool {
 public:
  Pool(std::size_t capacity, const std::function<T()>& make) : core_(capacity) {
    for (std::size_t i = 0; i < capacity; ++i) {
      auto node = std::make_unique<detail::PoolNode<T>>(make());
      node->index = static_cast<std::uint32_t>(i);
      node->core = &core_;
      core_.nodes.push_back(std::move(node));
      ENAMEL_CHECK(core_.free.push(static_cast<std::uint32_t>(i)));
    }
  }
  ~Pool() { ENAMEL_CHECK(core_.in_use.load() == 0, "a handle outlives its pool"); }
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;

  /// Empty handle when every object is in use, or the one that is free is just being put back by another thread.
  [[nodiscard]] Ref<T> try_acquire() noexcept {
    std::uint32_t index = 0;
    if (!core_.free.pop(index)) return {};
    const std::size_t used = core_.in_use.fetch_add(1, std::memory_order_relaxed) + 1;
    std::size_t peak = core_.peak.load(std::memory_order_relaxed);
    while (used > peak && !core_.peak.compare_exchange_weak(peak, used, std::memory_order_relaxed)) {
    }
    detail::PoolNode<T>* node = core_.nodes[index].get();
    node->references.store(1, std::memory_order_relaxed);
    return Ref<T>(node);
  }
  /// For pools whose capacity was computed to suffice: running dry is our defect.
  [[nodiscard]] Ref<T> acquire() {
    Ref<T> r = try_acquire();
    while (!r) {
      ENAMEL_CHECK(in_use() < capacity(), "pool exhausted: its capacity was computed too small");
      std::this_thread::yield();  // a thread was interrupted while it put an object back
      r = try_acquire();
    }
    return r;
  }

  [[nodiscard]] std::size_t capacity() const noexcept { return core_.nodes.size(); }
  [[nodiscard]] std::size_t in_use() const noexcept { return core_.in_use.load(std::memory_order_relaxed); }
  [[nodiscard]] std::size_t peak() const noexcept { return core_.peak.load(std::memory_order_relaxed); }

 private:
  detail::PoolCore<T> core_;
};

}  // namespace enamel
