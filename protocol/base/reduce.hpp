// Parallel loops whose result does not depend on the number of threads: fixed chunks, combined in index order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "protocol/base/check.hpp"

namespace enamel {

/// Runs independent tasks. Injected, so that algorithms own no threads.
class Workers {
 public:
  virtual ~Workers() = default;
  /// Calls task(0) … task(count - 1), each once, in any order, on any threads; returns when all have returned.
  /// Tasks must not throw and must not touch each other's data.
  virtual void run(std::size_t count, const std::function<void(std::size_t)>& task) = 0;
};

/// The calling thread, in order. The default, and the reference for any other.
class InlineWorkers final : public Workers {
 public:
  void run(std::size_t count, const std::function<void(std::size_t)>& task) override {
    for (std::size_t i = 0; i < count; ++i) task(i);
  }
  [[nodiscard]] static InlineWorkers& shared() {
    static InlineWorkers workers;
    return workers;
  }
};

/// body(begin, end) for chunks of at most `chunk` indices of [0, n). Chunk borders depend on n and chunk alone.
template <class Body>
void parallel_for(Workers& workers, std::size_t n, std::size_t chunk, const Body& body) {
  ENAMEL_CHECK(chunk > 0);
  const std::size_t chunks = n / chunk + (n % chunk != 0 ? 1 : 0);
  workers.run(chunks, [&](std::size_t c) { body(c * chunk, std::min(n, (c + 1) * chunk)); });
}

/// combine(…combine(combine(initial, map(chunk 0)), map(chunk 1))…): the same bits with any workers. map(begin, end) ->
/// T.
template <class T, class Map, class Combine>
[[nodiscard]] T parallel_reduce(Workers& workers, std::size_t n, std::size_t chunk, T initial, const Map& map,
                                const Combine& combine) {
  ENAMEL_CHECK(chunk > 0);
  const std::size_t chunks = n / chunk + (n % chunk != 0 ? 1 : 0);
  // A struct around T: vector<bool> would share words between chunks.
  struct Slot {
    T value;
  };
  std::vector<Slot> partial(chunks, Slot{initial});
  workers.run(chunks, [&](std::size_t c) { partial[c].value = map(c * chunk, std::min(n, (c + 1) * chunk)); });
  for (Slot& s : partial) initial = combine(std::move(initial), std::move(s.value));
  return initial;
}

}  // namespace enamel
