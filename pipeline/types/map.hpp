// Row-major image of T, pixel centres at integers, u right, v down. Invalid float pixels are NaN, never 0.
#pragma once

#include <cstddef>
#include <span>

#include "protocol/base/staggered.hpp"

namespace enamel {

template <class T>
class Map {
 public:
  Map() = default;
  Map(int width, int height, T fill = T{})
      : width_(width),
        height_(height),
        data_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill) {}
  /// Of pixels that have no value until they are written.
  [[nodiscard]] static Map unfilled(int width, int height) {
    Map out;
    out.width_ = width, out.height_ = height;
    out.data_ = StaggeredVector<T>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    return out;
  }

  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }
  [[nodiscard]] std::size_t size() const noexcept { return data_.size(); }
  [[nodiscard]] bool empty() const noexcept { return data_.empty(); }
  [[nodiscard]] bool contains(int u, int v) const noexcept { return u >= 0 && v >= 0 && u < width_ && v < height_; }
  [[nodiscard]] std::size_t index(int u, int v) const noexcept {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(u);
  }

  [[nodiscard]] T& operator()(int u, int v) noexcept { return data_[index(u, v)]; }
  [[nodiscard]] const T& operator()(int u, int v) const noexcept { return data_[index(u, v)]; }
  [[nodiscard]] T& operator[](std::size_t i) noexcept { return data_[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const noexcept { return data_[i]; }

  [[nodiscard]] std::span<T> pixels() noexcept { return data_; }
  [[nodiscard]] std::span<const T> pixels() const noexcept { return data_; }

 private:
  int width_ = 0;
  int height_ = 0;
  StaggeredVector<T> data_;
};

}  // namespace enamel
