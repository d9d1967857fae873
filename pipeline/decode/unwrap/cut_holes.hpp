// Holes of a mask, for unwrapping: invalid pixels that touch, corners included. A cut may end in a hole or pass through
// it for nothing.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/decode/unwrap/cut_costs.hpp"
#include "pipeline/decode/unwrap/segment_sets.hpp"

namespace enamel::pipeline {

class CutHoles {
 public:
  static constexpr std::int32_t kOutside = 0;  ///< layout: the hole that the image's border belongs to

  /// O(pixels). `torn`: 1 at every quad (of the pixel at its upper left) with an invalid pixel.
  void find(const CutCosts& costs);

  [[nodiscard]] std::int32_t count() const noexcept { return count_; }
  [[nodiscard]] bool torn(std::size_t quad) const noexcept { return torn_[quad] != 0; }
  /// Of a torn quad.
  [[nodiscard]] std::int32_t of(std::size_t quad) const noexcept;
  /// Torn quads of a hole, in order; of the outside: none.
  [[nodiscard]] std::span<const std::int32_t> quads(std::int32_t hole) const noexcept;

 private:
  struct Run {
    std::size_t begin = 0, end = 0;
  };
  void split_runs(const CutCosts& costs);
  void join_runs(SegmentSets& sets) const;
  void list_quads(const CutCosts& costs);

  std::vector<Run> runs_;
  std::vector<std::int32_t> label_;  ///< of invalid pixels
  std::vector<std::uint8_t> torn_;
  std::vector<std::int32_t> first_, quads_, numbers_, parent_;
  std::size_t stride_ = 0;
  std::int32_t count_ = 0;
  const std::uint8_t* valid_ = nullptr;
};

}  // namespace enamel::pipeline
