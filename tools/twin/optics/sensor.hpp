// Camera after the lens: point spread on the pixel grid, photon and read noise, full well, converter.
#pragma once

#include <cstdint>
#include <vector>

namespace enamel::twin {

struct SensorConfig {
  double psf_sigma_px = 0.6;  ///< 0: none
  double full_well_e = 10000;
  double read_noise_e = 5;
  double gain_e_per_dn = 39.84;
  double black_dn = 4;
  int bits = 8;
  bool shot_noise = true;
  bool read_noise = true;
};

/// Which image a noise field belongs to.
struct ExposureId {
  std::uint64_t seed = 0;
  std::uint64_t burst = 0;
  int frame = 0;
};

/// Separable Gaussian on the pixel grid; beyond the borders the light goes on in a straight line. In place; rows
/// top-down, width*height floats.
void apply_psf(std::vector<float>& image, int width, int height, double sigma_px);

/// Mean electrons -> samples as the sensor delivers them: one byte a pixel for bits <= 8, else two, little endian.
[[nodiscard]] std::vector<std::uint8_t> digitise(const std::vector<float>& electrons, const SensorConfig& config,
                                                 const ExposureId& id);

/// Mean and variance of one sample of a pixel, DN, behind photon and read noise, full well and converter.
struct SampleMoments {
  double mean = 0, variance = 0;
};

/// The same mean light taken `frames` times and averaged, DN. Drawn from the normal distribution with the moments of
/// one sample: the limit that the mean of sixteen frames is near, at the cost of one draw.
class FrameAverager {
 public:
  FrameAverager(const SensorConfig& config, int frames);

  [[nodiscard]] SampleMoments moments(double mean_e) const;
  [[nodiscard]] std::vector<float> average(const std::vector<float>& electrons, const ExposureId& id) const;

 private:
  SensorConfig config_;
  double frames_;
  double step_e_ = 0;                 ///< between entries of the table
  std::vector<SampleMoments> table_;  ///< by mean electrons
};

}  // namespace enamel::twin
