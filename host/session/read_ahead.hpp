// The next of a row of things made on another thread while the one before is worked on. Private to host/session.
#pragma once

#include <cstddef>
#include <functional>
#include <future>
#include <utility>

namespace enamel::host {

template <class T>
class ReadAhead {
 public:
  /// `make` is called from other threads, for one thing at a time, 0 to `count` - 1; what it refers to must outlive
  /// this.
  ReadAhead(std::size_t count, std::function<T(std::size_t)> make) : count_(count), make_(std::move(make)) { ask(); }
  ReadAhead(const ReadAhead&) = delete;  // the thread refers to it
  ReadAhead& operator=(const ReadAhead&) = delete;

  /// At most `count` times.
  [[nodiscard]] T next() {
    T out = coming_.get();
    ask();
    return out;
  }

 private:
  void ask() {
    if (asked_ >= count_) return;
    coming_ = std::async(std::launch::async, [this, n = asked_] { return make_(n); });
    ++asked_;
  }
  std::size_t count_, asked_ = 0;
  std::function<T(std::size_t)> make_;
  std::future<T> coming_;  ///< last: waits for what still runs, before the rest goes
};

}  // namespace enamel::host
