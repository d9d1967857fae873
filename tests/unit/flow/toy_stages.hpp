// A toy pipeline for the graph's tests: integers for maps, hashing for work.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/flow/executor.hpp"
#include "pipeline/flow/graph.hpp"
#include "protocol/base/rng.hpp"
#include "protocol/base/sha256.hpp"

namespace enamel::flow {

using Number = std::uint64_t;

/// Cheap, not commutative, depends on every bit.
inline Number mix(Number a, Number b) { return Rng(a, b, 0).next_u64(); }

/// Work of varying length, so that schedules differ.
inline void random_work(Number a, Number b) {
  Number sink = 0;
  for (Number n = mix(a, b) % 1024; n > 0; --n) sink = mix(sink, n);
  ENAMEL_CHECK(sink != 1);  // keeps the loop
}

/// Emits bursts 0 … count − 1.
class CountingSource final : public Source {
 public:
  CountingSource(std::string name, Number count) : Source(std::move(name)), count_(count) {}
  Out<Number> out{*this, "out"};
  [[nodiscard]] Result<Pull> pull() override {
    if (next_ == count_) return Pull::kEnd;
    if (before_item) before_item(next_);
    const ItemHead head{BurstId{next_}, device_time(static_cast<std::int64_t>(next_) * 1000), nullptr, false};
    out.emit(make_item<Number>(head, next_));
    ++next_;
    pulled.store(next_);
    return Pull::kItem;
  }
  void stop() noexcept override {
    if (on_stop) on_stop();
  }
  std::function<void(Number)> before_item;
  std::function<void()> on_stop;
  std::atomic<Number> pulled{0};

 private:
  Number count_;
  Number next_ = 0;
};

/// One in, one out, by a function.
class MapStage final : public Stage {
 public:
  using Fn = std::function<Item<Number>(const Item<Number>&)>;
  MapStage(std::string name, Fn fn) : Stage(std::move(name)), fn_(std::move(fn)) {}
  In<Number> in{*this, "in"};
  Out<Number> out{*this, "out"};
  [[nodiscard]] Result<void> step() override {
    const bool was_inside = inside_.exchange(true);
    ENAMEL_CHECK(!was_inside, "two workers inside one stage");
    const Item<Number> item = in.take();
    out.emit(fn_(item));
    inside_.store(false);
    return {};
  }
  void stop() noexcept override {
    if (on_stop) on_stop();
  }
  std::function<void()> on_stop;

 private:
  Fn fn_;
  std::atomic<bool> inside_{false};
};

/// Keeps everything that arrives, tombstones too.
class CollectSink final : public Stage {
 public:
  explicit CollectSink(std::string name) : Stage(std::move(name)) {}
  In<Number> in{*this, "in"};
  [[nodiscard]] Result<void> step() override {
    items.push_back(in.take());
    if (on_item) on_item(items.back());
    return {};
  }
  void stop() noexcept override {
    if (on_stop) on_stop();
  }
  [[nodiscard]] bool handles_rejected() const noexcept override { return true; }
  [[nodiscard]] std::string hash() const {
    RollingHash h;
    for (const Item<Number>& i : items) {
      h.update_value(i.id.value).update_value(i.ok() ? *i : Number{0}).update(i.ok() ? "" : i.rejected);
    }
    return h.hex();
  }
  std::vector<Item<Number>> items;
  std::function<void(const Item<Number>&)> on_item;
  std::function<void()> on_stop;
};

/// Joins a burst with the model; the pose depends on both.
class RegisterStage final : public Stage {
 public:
  explicit RegisterStage(std::string name) : Stage(std::move(name)) {}
  In<Number> in{*this, "in"};
  In<Number> model{*this, "model"};
  Out<Number> out{*this, "out"};
  [[nodiscard]] Result<void> step() override {
    const Item<Number> item = in.take();
    const Item<Number> view = model.take();
    seen_models.push_back(view.ok() ? *view : Number{0});
    random_work(11, item.id.value);
    out.emit(make_item<Number>(item, mix(*item, seen_models.back())));
    return {};
  }
  std::vector<Number> seen_models;
};

/// Folds poses into a model; a rejected burst leaves the model as it was.
class FuseStage final : public Stage {
 public:
  explicit FuseStage(std::string name) : Stage(std::move(name)) {}
  In<Number> in{*this, "in"};
  Out<Number> view{*this, "view"};
  Out<Number> out{*this, "out"};
  [[nodiscard]] bool handles_rejected() const noexcept override { return true; }
  [[nodiscard]] Result<void> step() override {
    const Item<Number> item = in.take();
    if (before) before(item.id.value);
    random_work(12, item.id.value);
    if (item.ok()) model_ = mix(model_, *item);
    ItemHead head = item;
    head.rejected = nullptr;
    view.emit(make_item<Number>(head, model_));
    out.emit(item.ok() ? make_item<Number>(item, model_) : make_rejected<Number>(item, nullptr));
    if (after) after(item.id.value);
    return {};
  }
  std::function<void(Number)> before;
  std::function<void(Number)> after;

 private:
  Number model_ = 0;
};

/// source -> decode (rejects every 7th) -> register (feedback) -> fuse -> sink, and a viewer behind a keep-latest edge.
struct ToyPipeline {
  explicit ToyPipeline(Number count, std::size_t delay = 2) : graph(clock) {
    source = &graph.add<CountingSource>("source", count);
    decode = &graph.add<MapStage>("decode", [](const Item<Number>& i) {
      random_work(10, i.id.value);
      return i.id.value % 7 == 3 ? make_rejected<Number>(i, "low_modulation") : make_item<Number>(i, mix(5, *i));
    });
    reg = &graph.add<RegisterStage>("register");
    fuse = &graph.add<FuseStage>("fuse");
    sink = &graph.add<CollectSink>("sink");
    viewer = &graph.add<CollectSink>("viewer");
    graph.connect(source->out, decode->in);
    graph.connect(decode->out, reg->in);
    graph.connect(reg->out, fuse->in);
    graph.connect_feedback(fuse->view, reg->model, delay, make_rejected<Number>({}, "no_model"));
    graph.connect(fuse->out, sink->in);
    graph.connect(fuse->out, viewer->in, {.on_full = OnFull::kKeepLatest});
  }
  SteadyClock clock;
  Graph graph;
  CountingSource* source;
  MapStage* decode;
  RegisterStage* reg;
  FuseStage* fuse;
  CollectSink* sink;
  CollectSink* viewer;
};

/// 0 workers: the inline executor.
inline Result<void> run_with(std::size_t workers, Graph& graph, const std::stop_token& stop = {}) {
  if (workers == 0) return InlineExecutor().run(graph, stop);
  return WorkerExecutor(workers).run(graph, stop);
}

inline const StageSnapshot& stage_of(const GraphSnapshot& s, const std::string& name) {
  for (const StageSnapshot& stage : s.stages) {
    if (stage.name == name) return stage;
  }
  ENAMEL_CHECK(false, "no such stage");
}

}  // namespace enamel::flow
