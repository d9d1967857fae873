// Memory of a few rows of an image for as long as a step takes. Steps ask for it many times a burst; each thread keeps
// what they give back, so that the heap is asked for none of it once the first bursts are through.
#pragma once

#include <cstddef>
#include <vector>

namespace enamel::pipeline {

/// Of one thread: ends on the thread that it began on. Move only.
class RowMemory {
 public:
  RowMemory() = default;
  /// What it holds is undefined.
  explicit RowMemory(std::size_t floats);
  RowMemory(std::size_t floats, float value);
  RowMemory(RowMemory&& other) noexcept = default;
  RowMemory& operator=(RowMemory&& other) noexcept;
  RowMemory(const RowMemory&) = delete;
  RowMemory& operator=(const RowMemory&) = delete;
  ~RowMemory();

  [[nodiscard]] float* data() noexcept { return floats_.data(); }
  [[nodiscard]] const float* data() const noexcept { return floats_.data(); }
  [[nodiscard]] std::size_t size() const noexcept { return floats_.size(); }
  [[nodiscard]] float& operator[](std::size_t i) noexcept { return floats_[i]; }
  [[nodiscard]] float operator[](std::size_t i) const noexcept { return floats_[i]; }

 private:
  void give_back() noexcept;

  std::vector<float> floats_;
};

}  // namespace enamel::pipeline
