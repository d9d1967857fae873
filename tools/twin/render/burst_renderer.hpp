// Mean light of the four frames of a burst. Thread count never changes a bit: every pixel is summed alone, in order.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tools/twin/movers/mover_stage.hpp"
#include "tools/twin/render/light_tracer.hpp"

namespace enamel::twin {

/// Sub-pixel position and instant of the samples: grid*grid rooks on a rotated grid, point-symmetric about the pixel
/// centre, so that no frame is shifted against another by sampling.
struct SamplePattern {
  explicit SamplePattern(int grid);
  std::vector<double> dx, dy;      ///< px, in (-0.5, 0.5)
  std::vector<std::size_t> order;  ///< instant of a sample, 0 … grid*grid-1; odd rows use the reverse
};

/// What lies behind the pixel centres at one pose. Rows top-down.
struct TruthMaps {
  std::vector<float> depth;         ///< camera z, mm; NaN = nothing there
  std::vector<std::uint8_t> lit;    ///< 255 where the projector reaches the surface, else 0
  std::vector<std::uint8_t> order;  ///< floor(u_p / period); 255 = outside the projector frame
  std::vector<std::uint8_t> mover;  ///< 0: the mouth; n: what the depth shows is guest n - 1
};

/// What is not the same in every burst: bodies that move by themselves, and the lamp's light relative to its mean.
struct Passing {
  BurstGuests guests;
  std::array<double, 4> lamp{1, 1, 1, 1};  ///< a frame
};

class BurstRenderer {
 public:
  /// Keeps references: instrument and scene must outlive the renderer.
  BurstRenderer(const Instrument& instrument, const RayScene& scene, const RenderConfig& config);

  /// Fraction of full well, before the camera's point spread. Rows top-down.
  [[nodiscard]] std::array<std::vector<float>, 4> render(const BurstPoses& poses, const Passing& passing = {}) const;

  [[nodiscard]] TruthMaps truth(const Pose& T_model_cam, const Guests& guests = {}) const;

 private:
  using RowSums = std::array<std::vector<double>, 4>;

  static void agree(const std::array<std::vector<Shade>, 2>& outer, std::vector<Shade>& known);
  [[nodiscard]] double axis_coordinate(const Lane& lane) const { return instrument_.light.axis_v() ? lane.v : lane.u; }
  struct Frames {
    std::size_t first, end;
    const std::array<double, 4>& lamp;
  };
  void add_light(const Lanes8& lights, std::size_t x0, const Frames& frames, RowSums& sums) const;
  void render_row(const std::vector<View>& views, const std::array<double, 4>& lamp, int y, RowSums& sums) const;
  void truth_row(const View& view, int y, TruthMaps& maps) const;

  const Instrument& instrument_;
  LightTracer tracer_;
  RenderConfig config_;
  SamplePattern pattern_;
  int width_, height_;
  std::vector<double> directions_;  ///< x/z, y/z a sample: [row][sample][column][2]
  std::vector<double> centres_;     ///< the same at pixel centres
};

}  // namespace enamel::twin
