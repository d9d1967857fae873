// A body at rest under many patterns: rays are traced once a pose, every pattern is then a look-up a sample.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tools/twin/render/light_tracer.hpp"

namespace enamel::twin {

/// One camera sample: where the projector's light comes from and what returns of it, in full-well fractions.
struct StillSample {
  double u = 0, v = 0;  ///< projector coordinates
  float weight = 0;     ///< at emission 1
  float ambient = 0;
  float sigma2 = 0;  ///< projector blur, px²
};

/// Samples of all pixels of one pose: those of pixel i are samples[first[i]] … samples[first[i + 1] - 1], and the
/// pixel is their mean. Rows top-down.
struct StillView {
  std::vector<std::uint32_t> first;
  std::vector<StillSample> samples;
};

/// Thread-safe.
class StillRenderer {
 public:
  /// Keeps references: instrument and scene must outlive the renderer.
  StillRenderer(const Instrument& instrument, const RayScene& scene, const RenderConfig& config);

  /// config.grid² samples a pixel, kEdgeGrid² where albedo or shade changes within the pixel or to a neighbour.
  [[nodiscard]] StillView trace(const Pose& T_model_cam) const;

  /// The four frames of `light` on a traced view, before the camera's point spread. Threads never change a bit.
  [[nodiscard]] static std::array<std::vector<float>, 4> shade(const StillView& view, const ProjectorLight& light);

  static constexpr int kEdgeGrid = 12;  ///< a disc of 12 px radius then has its centre to 0.002 px

 private:
  struct Row;
  using Samples = std::vector<StillSample>;
  void trace_row(const View& view, int y, Row& row) const;
  void trace_edge_pixel(const View& view, int x, int y, Samples& out) const;

  const Instrument& instrument_;
  LightTracer tracer_;
  std::vector<double> dx_, dy_;            ///< samples of a pixel, px from its centre
  std::vector<double> edge_dx_, edge_dy_;  ///< of an edge pixel
  int width_, height_;
};

}  // namespace enamel::twin
