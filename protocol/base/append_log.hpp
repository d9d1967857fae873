// A sequence that only grows and is shared as it stands: appending and sharing cost the same however long it is.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace enamel {

/// One writer. Views may be read by any thread that got them by a hand-over: what a view shows is never written again.
/// T is default constructible.
template <class T, std::size_t kChunk = 256>
class AppendLog {
  struct Chunk {
    std::array<T, kChunk> items{};
    std::shared_ptr<Chunk> before;
    /// One after the other: a long log would let chunks destroy each other recursively.
    ~Chunk() {
      while (before && before.use_count() == 1) before = std::exchange(before->before, nullptr);
    }
  };

 public:
  /// What had been appended when it was taken.
  class View {
   public:
    View() = default;
    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    [[nodiscard]] bool empty() const noexcept { return size_ == 0; }

    /// visit(const T&) from the newest to the oldest; the references hold as long as the view.
    template <class Visit>
    void newest_first(Visit&& visit) const {
      std::size_t end = size_;
      for (const Chunk* chunk = last_.get(); end > 0; chunk = chunk->before.get()) {
        const std::size_t first = (end - 1) / kChunk * kChunk;
        for (; end > first; --end) visit(chunk->items[end - 1 - first]);
      }
    }
    [[nodiscard]] std::vector<T> in_order() const {
      std::vector<T> out(size_);
      auto at = out.rbegin();
      newest_first([&](const T& item) { *at++ = item; });
      return out;
    }

   private:
    friend class AppendLog;
    View(std::shared_ptr<const Chunk> last, std::size_t size) : last_(std::move(last)), size_(size) {}
    std::shared_ptr<const Chunk> last_;
    std::size_t size_ = 0;
  };

  void append(T item) {
    const std::size_t at = size_ % kChunk;
    if (at == 0) {
      auto next = std::make_shared<Chunk>();
      next->before = std::exchange(last_, nullptr);
      last_ = std::move(next);
    }
    last_->items[at] = std::move(item);  // behind the end of every view
    ++size_;
  }
  [[nodiscard]] View view() const { return {last_, size_}; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  std::shared_ptr<Chunk> last_;
  std::size_t size_ = 0;
};

}  // namespace enamel
