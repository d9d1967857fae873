// Typed ends of a stage. Only an Out<T> and an In<T> of the same T connect; anything else does not compile.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/flow/edge.hpp"

namespace enamel::flow {

class Stage;

/// What the executor sees of an input.
class InBase {
 public:
  InBase(Stage& owner, std::string_view name);
  InBase(const InBase&) = delete;
  InBase& operator=(const InBase&) = delete;

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] Stage& owner() const noexcept { return owner_; }
  [[nodiscard]] bool is_feedback() const noexcept { return feedback_; }

  [[nodiscard]] virtual bool connected() const noexcept = 0;
  [[nodiscard]] virtual const ItemHead* head() = 0;  ///< of the next item; null: none now
  [[nodiscard]] virtual EdgeBase& next_edge() = 0;   ///< that the next item comes from
  [[nodiscard]] virtual bool ended() = 0;
  virtual void discard() = 0;  ///< takes the next item away

  void begin_step() noexcept { taken_ = 0; }
  [[nodiscard]] int taken() const noexcept { return taken_; }

 protected:
  ~InBase() = default;
  void count_take() noexcept { ++taken_; }
  void mark_feedback() noexcept { feedback_ = true; }

 private:
  Stage& owner_;
  std::string name_;
  int taken_ = 0;
  bool feedback_ = false;
};

/// What the executor sees of an output.
class OutBase {
 public:
  OutBase(Stage& owner, std::string_view name);
  OutBase(const OutBase&) = delete;
  OutBase& operator=(const OutBase&) = delete;

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] Stage& owner() const noexcept { return owner_; }

  [[nodiscard]] virtual bool connected() const noexcept = 0;
  [[nodiscard]] virtual EdgeBase* full_edge() noexcept = 0;  ///< that has no room for the next item; null: none
  virtual void emit_rejected(const ItemHead& head, const char* reason) = 0;
  virtual void close() noexcept = 0;
  /// Declares that nobody needs this output.
  void ignore() noexcept { ignored_ = true; }
  [[nodiscard]] bool ignored() const noexcept { return ignored_; }

  void begin_step(bool degraded) noexcept {
    emitted_ = 0;
    degraded_ = degraded;
  }
  [[nodiscard]] int emitted() const noexcept { return emitted_; }
  [[nodiscard]] const ItemHead& last() const noexcept { return last_; }

 protected:
  ~OutBase() = default;
  /// False when the step has emitted here before: then there may be no room and the item is dropped, for the executor
  /// to report the stage as faulty.
  [[nodiscard]] bool count_emit(ItemHead& head) noexcept {
    head.degraded = head.degraded || degraded_;
    if (++emitted_ > 1) return false;
    last_ = head;
    return true;
  }

 private:
  Stage& owner_;
  std::string name_;
  ItemHead last_;
  int emitted_ = 0;
  bool degraded_ = false;
  bool ignored_ = false;
};

template <class T>
class In final : public InBase {
 public:
  using InBase::InBase;

  /// The next item; exactly once in each step.
  [[nodiscard]] Item<T> take() {
    count_take();
    Item<T>* front = lanes_.empty() ? nullptr : lane().front();
    ENAMEL_CHECK(front != nullptr, "take() outside step(), or twice in one step");
    Item<T> item = std::move(*front);
    lane().pop();
    ++turn_;
    return item;
  }

  /// Lanes are read in turn: one, unless replicas of a stage are merged here.
  void attach(std::vector<Edge<T>*> lanes, bool feedback) {
    lanes_ = std::move(lanes);
    if (feedback) mark_feedback();
  }
  [[nodiscard]] bool connected() const noexcept override { return !lanes_.empty(); }
  [[nodiscard]] const ItemHead* head() override { return lane().front(); }
  [[nodiscard]] EdgeBase& next_edge() override { return lane(); }
  [[nodiscard]] bool ended() override { return lane().ended(); }
  void discard() override { static_cast<void>(take()); }

 private:
  Edge<T>& lane() noexcept { return *lanes_[turn_ % lanes_.size()]; }

  std::vector<Edge<T>*> lanes_;
  std::size_t turn_ = 0;
};

template <class T>
class Out final : public OutBase {
 public:
  using OutBase::OutBase;

  /// Hands the item to every connected edge (they share the payload); exactly once in each step.
  void emit(Item<T> item) {
    if (!count_emit(item)) return;
    for (const std::vector<Edge<T>*>& lanes : links_) lanes[turn_ % lanes.size()]->push(item);
    ++turn_;
  }

  /// One link a consumer; its lanes are fed in turn: one, unless the consumer is replicated.
  void attach(std::vector<Edge<T>*> lanes) { links_.push_back(std::move(lanes)); }
  [[nodiscard]] bool connected() const noexcept override { return !links_.empty(); }
  [[nodiscard]] EdgeBase* full_edge() noexcept override {
    for (const auto& lanes : links_) {
      Edge<T>* lane = lanes[turn_ % lanes.size()];
      if (!lane->writable()) return lane;
    }
    return nullptr;
  }
  void emit_rejected(const ItemHead& head, const char* reason) override { emit(make_rejected<T>(head, reason)); }
  void close() noexcept override {
    for (const auto& lanes : links_) {
      for (Edge<T>* e : lanes) e->close();
    }
  }

 private:
  std::vector<std::vector<Edge<T>*>> links_;
  std::size_t turn_ = 0;
};

}  // namespace enamel::flow
