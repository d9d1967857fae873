// The surface that a scan's stops have seen, coarsely: cells of half a millimetre with normal and best incidence, and
// what is expected to lie beyond their rim. Model frame of pose_by_axes, mm. Deterministic; one owner.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

struct SeenPoint {
  Vec3f point = Vec3f::Zero(), normal = Vec3f::Zero();
  float cosine = 0;  ///< of the worse incidence: of the camera's ray or of the projector's
};

struct SeenCell {
  Vec3f point = Vec3f::Zero(), normal = Vec3f::Zero();  ///< means; normal is unit
  float area_mm2 = 0;                                   ///< of a plane of this normal in a cell
  float cosine = 0;                                     ///< best of all stops
  std::uint8_t vain = 0;                                ///< stops that should have seen it better and did not
};

/// A guess: the surface goes on beyond its rim as it ran there.
struct ExpectedCell {
  Vec3f point = Vec3f::Zero(), normal = Vec3f::Zero();
  float weight = 0;  ///< less with the distance from the rim, halved by every stop that looked there in vain
  std::uint64_t key = 0;
};

class SeenSurface {
 public:
  /// reach_mm: how far beyond the rim the surface is guessed.
  SeenSurface(double cell_mm, double reach_mm);

  /// A stop's points. Cells and rim are up to date afterwards, expected() after expect().
  void add(const std::vector<SeenPoint>& points);

  /// Guesses anew what lies beyond the rim. `is_void`: whether a stop has seen that there is nothing.
  template <class IsVoid>
  void expect(IsVoid is_void) {
    begin_guess();
    while (const auto guess = next_guess()) {
      if (!is_void(guess->point)) keep(*guess);
    }
  }

  [[nodiscard]] const std::vector<SeenCell>& cells() const noexcept { return cells_; }
  [[nodiscard]] const std::vector<ExpectedCell>& expected() const noexcept { return expected_; }
  [[nodiscard]] double expected_cell_mm() const noexcept { return 2 * cell_mm_; }
  /// Of the cells seen at `least_cosine` or better.
  [[nodiscard]] double area_mm2(double least_cosine) const;

  void cell_in_vain(std::size_t cell) { ++cells_[cell].vain; }
  void expected_in_vain(std::size_t n) {
    ++vain_[expected_[n].key];
    expected_[n].weight *= 0.5F;
  }

 private:
  struct Sums {
    Vec3f point = Vec3f::Zero(), normal = Vec3f::Zero();
    std::uint32_t points = 0;
    float stop_cosine = 0;  ///< of the stop that is being added
    std::uint32_t stop_points = 0;
  };
  struct Rim {
    std::uint32_t cell = 0;
    std::uint8_t open = 0;  ///< bit a tangent direction
  };

  void close_stop(std::uint32_t cell);
  void find_rim(std::size_t first_new);
  [[nodiscard]] std::uint8_t open_directions(const SeenCell& cell) const;
  [[nodiscard]] bool is_near_seen(const Vec3f& point) const;
  void begin_guess();
  [[nodiscard]] std::optional<ExpectedCell> next_guess();
  void keep(const ExpectedCell& guess);

  double cell_mm_;
  int steps_;  ///< of an expected cell each, beyond the rim
  std::vector<SeenCell> cells_;
  std::vector<Sums> sums_;
  std::unordered_map<std::uint64_t, std::uint32_t> at_;  ///< cell by place
  std::vector<Rim> rim_;
  std::vector<ExpectedCell> expected_;
  std::unordered_map<std::uint64_t, std::uint32_t> expected_at_;
  std::unordered_map<std::uint64_t, std::uint8_t> vain_;
  std::size_t guess_rim_ = 0;
  int guess_direction_ = 0, guess_step_ = 0;
};

}  // namespace enamel::pipeline
