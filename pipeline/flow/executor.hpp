// Runs a graph to its end. Which executor, and how many workers, never changes what the stages compute.
#pragma once

#include <stop_token>

#include "pipeline/flow/graph.hpp"
#include "protocol/base/result.hpp"

namespace enamel::flow {

/// run() validates and starts the stages, returns when every stage has ended, and may be called once per graph.
/// A stop request ends the sources; what is under way drains in order and run() returns success.
/// Errors: what validate() says; the error of start(); the first fatal error of a step; kInternal naming the stage that
/// broke the contract "one item in, one item out, same burst" or threw.
class Executor {
 public:
  virtual ~Executor() = default;
  [[nodiscard]] virtual Result<void> run(Graph& graph, const std::stop_token& stop = {}) = 0;
};

/// Everything on the calling thread, in topological order.
class InlineExecutor final : public Executor {
 public:
  [[nodiscard]] Result<void> run(Graph& graph, const std::stop_token& stop = {}) override;
};

/// `workers` threads, the calling one among them. Any worker runs any stage that can run, the one nearest the sinks
/// first; idle workers sleep.
class WorkerExecutor final : public Executor {
 public:
  explicit WorkerExecutor(std::size_t workers) : workers_(workers > 0 ? workers : 1) {}
  [[nodiscard]] Result<void> run(Graph& graph, const std::stop_token& stop = {}) override;

 private:
  std::size_t workers_;
};

}  // namespace enamel::flow
