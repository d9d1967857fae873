#include "pipeline/flow/parallel.hpp"

#include <atomic>
#include <thread>
#include <vector>

namespace enamel::flow {

void for_each_index(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  const auto run = [&] {
    for (std::size_t n = next++; n < count; n = next++) work(n);
  };
  std::vector<std::jthread> others;
  for (std::size_t k = 1; k < threads && k < count; ++k) others.emplace_back(run);
  run();
}

}  // namespace enamel::flow
