// How fine each part of the model is drawn: by its size on the screen, within a number of triangles that follows from
// what frames took; and with how many pixels, where fewer triangles no longer help. Level 0 is the mesh as it is.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "viewer/scene/ball.hpp"
#include "viewer/scene/view_camera.hpp"

namespace enamel::view {

/// Cells of the coarse levels, mm. chosen: twice a voxel of 0.1 mm, then doubled until half a part's edge.
inline constexpr std::array<float, 4> kCoarseCellMm{0.2F, 0.4F, 0.8F, 1.6F};
inline constexpr std::size_t kLevels = kCoarseCellMm.size() + 1;

/// A part of the model as the choice sees it.
struct DetailPart {
  Ball ball;
  std::array<std::size_t, kLevels> triangles{};  ///< of each level; of one that is not made yet, a guess
  std::uint8_t last = 0;                         ///< level that it was last drawn with
};

struct DetailView {
  ViewCamera camera;
  double aspect = 1;
  int height_px = 1;
  std::optional<Ball> focus;  ///< what is being scanned: gives up detail last
};

struct DetailChoice {
  std::size_t part = 0;
  std::uint8_t level = 0;
};

/// The parts in view, nearest first, each with its level. The sum of their triangles is at most `budget` where the
/// coarsest levels allow it. A function of its arguments alone.
[[nodiscard]] std::vector<DetailChoice> choose_detail(std::span<const DetailPart> parts, const DetailView& view,
                                                      std::size_t budget);

/// How many triangles a frame may have so that it takes `target_ms`, and how many pixels. Triangles go first and come
/// back last. A function of what it is told.
class DetailBudget {
 public:
  static constexpr std::size_t kLeast = 30'000;  ///< chosen: fewer save little beside the pixels
  static constexpr std::size_t kMost = 4'000'000;
  /// chosen: what two cores draw in software within the target.
  static constexpr std::size_t kSoftwareStart = 60'000;

  explicit DetailBudget(double target_ms, std::size_t start) : target_ms_(target_ms), triangles_(start) {}

  /// A frame of so many triangles took `frame_ms`. Slow frames take effect at once, quick ones slowly, and only where
  /// the budget was what limited them.
  void drawn(double frame_ms, std::size_t triangles) noexcept;
  [[nodiscard]] std::size_t triangles() const noexcept { return triangles_; }
  /// Of the window's width and height, what the model is drawn with: 1, or less where a renderer in software is too
  /// slow for its pixels.
  [[nodiscard]] double sharpness() const noexcept { return kSharpness[blur_]; }

 private:
  static constexpr std::array kSharpness{1.0, 0.75, 0.5};  ///< chosen: teeth are told apart with the last
  void judge_pixels(double frame_ms, bool pixels_alone) noexcept;

  double target_ms_;
  std::size_t triangles_;
  std::size_t blur_ = 0;     ///< of kSharpness
  int slow_ = 0, fast_ = 0;  ///< frames on end, of too many pixels and of room for more
};

}  // namespace enamel::view
