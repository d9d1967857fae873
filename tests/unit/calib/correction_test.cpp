// Step 0 on pictures with a planted dark pattern, shading and pixels of unlike gain.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

#include "calib/io/calib_folder.hpp"
#include "calib/io/frame_correction.hpp"
#include "protocol/base/file.hpp"
#include "tests/support/rig_files.hpp"
#include "tests/support/run.hpp"

namespace enamel::calib {
namespace {

constexpr int kWidth = 200, kHeight = 150;
constexpr double kSlope_dn = 0.02, kFloor_dn2 = 0.5, kFlat_dn = 170;

/// A sensor: per pixel an offset and a gain, over the field a shading.
struct Sensor {
  double offset_sigma_dn = 3, gain_sigma = 0.02, shading = 0.3;

  Map<float> offset{kWidth, kHeight}, gain{kWidth, kHeight};

  void make(Rng& rng) {
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const double x = u / (kWidth - 1.0) - 0.5, y = v / (kHeight - 1.0) - 0.5;
        offset(u, v) = static_cast<float>(12 + offset_sigma_dn * rng.normal());
        gain(u, v) = static_cast<float>((1 - 2 * shading * (x * x + y * y)) * (1 + gain_sigma * rng.normal()));
      }
    }
  }
  [[nodiscard]] Map<float> picture(double light_dn, Rng& rng) const {
    Map<float> out(kWidth, kHeight);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double signal = light_dn * static_cast<double>(gain[i]);
      const double noise = std::sqrt(kFloor_dn2 + kSlope_dn * signal) * rng.normal();
      out[i] = static_cast<float>(std::round(static_cast<double>(offset[i]) + signal + noise));
    }
    return out;
  }
};

double relative_spread(const Map<float>& image) {
  double sum = 0, squares = 0;
  for (const float p : image.pixels()) {
    sum += static_cast<double>(p);
    squares += static_cast<double>(p) * static_cast<double>(p);
  }
  const double n = static_cast<double>(image.size()), mean = sum / n;
  return std::sqrt(squares / n - mean * mean) / mean;
}

class Correction : public testing::Test {
 protected:
  void write(const Sensor& sensor, int dark_frames, bool with_flat) {
    Rng rng(7, 1, 1);
    for (int i = 0; i < dark_frames; ++i)
      test::write_png(folder_ / ("dark_" + std::to_string(i) + ".png"), sensor.picture(0, rng));
    if (with_flat) test::write_png(folder_ / "flat.png", sensor.picture(kFlat_dn, rng));
  }
  Result<FrameCorrection> read(std::optional<PixelNoise> rig_noise = {}) const {
    return read_correction(folder_.path().string(), kWidth, kHeight, 255, rig_noise);
  }
  static Sensor sensor(Sensor s = {}) {
    Rng rng(3, 1, 1);
    s.make(rng);
    return s;
  }

  test::TempFolder folder_;
  Rng rng_{11, 1, 1};
};

TEST_F(Correction, shading_and_dark_pattern_go) {
  const Sensor s = sensor();
  write(s, 12, true);
  const FrameCorrection c = read(PixelNoise{kFloor_dn2 + 1.0 / 12, kSlope_dn}).value();
  Map<float> image = s.picture(90, rng_);
  const double before = relative_spread(image);
  c.apply(image);
  // What pixels' noise leaves when the picture, twelve dark frames and the flat field all bring theirs in full.
  double left = 0;
  for (const float g : s.gain.pixels()) {
    const double signal = 90 * static_cast<double>(g), flat = kFlat_dn * static_cast<double>(g);
    const double dark = (kFloor_dn2 + 1.0 / 12) / 12;
    left += ((kFloor_dn2 + 1.0 / 12 + kSlope_dn * signal + dark) / (signal * signal) +
             (kFloor_dn2 + 1.0 / 12 + kSlope_dn * flat + dark) / (flat * flat)) /
            static_cast<double>(s.gain.size());
  }
  EXPECT_GT(before, 3 * std::sqrt(left)) << "the planted pattern must matter";
  EXPECT_LT(relative_spread(image), 1.02 * std::sqrt(left));
}

TEST_F(Correction, noise_is_that_of_the_sensor) {
  const Sensor even = sensor(
      {.offset_sigma_dn = 3, .gain_sigma = 0, .shading = 0.3, .offset = {kWidth, kHeight}, .gain = {kWidth, kHeight}});
  write(even, 12, true);
  const FrameCorrection c = read().value();
  ASSERT_TRUE(c.noise);
  EXPECT_NEAR(c.noise->floor_dn2, kFloor_dn2 + 1.0 / 12, 0.05 * kFloor_dn2);
  EXPECT_NEAR(c.noise->slope_dn, kSlope_dn, 0.1 * kSlope_dn);
}

TEST_F(Correction, an_even_sensor_is_not_made_worse_by_the_noise_of_dark_and_flat) {
  const Sensor even = sensor(
      {.offset_sigma_dn = 0, .gain_sigma = 0, .shading = 0, .offset = {kWidth, kHeight}, .gain = {kWidth, kHeight}});
  write(even, 2, true);
  const FrameCorrection c = read().value();
  Map<float> image = even.picture(90, rng_);
  Map<float> corrected = image;
  c.apply(corrected);
  const double level = 90.0 / 102;  // the offset counts for the spread's mean before it is subtracted
  EXPECT_LT(relative_spread(corrected) * level, 1.03 * relative_spread(image));
}

TEST_F(Correction, absent_pictures_change_nothing) {
  const FrameCorrection c = read().value();
  EXPECT_TRUE(c.is_empty());
  EXPECT_FALSE(c.noise);
}

TEST_F(Correction, a_single_dark_frame_gives_its_level_only) {
  const Sensor s = sensor();
  write(s, 1, false);
  const FrameCorrection c = read().value();
  EXPECT_EQ(c.dark_frames, 1);
  EXPECT_EQ(c.dark(3, 4), c.dark(90, 70));
  EXPECT_NEAR(static_cast<double>(c.dark(0, 0)), 12, 0.1);
}

TEST_F(Correction, saturated_dark_and_ill_sized_pictures_are_named) {
  const Sensor s = sensor();
  Rng rng(5, 1, 1);
  test::write_png(folder_ / "flat.png", s.picture(400, rng));
  EXPECT_THAT(read().error().detail, testing::HasSubstr("saturated"));
  test::write_png(folder_ / "flat.png", s.picture(4, rng));
  EXPECT_THAT(read().error().detail, testing::HasSubstr("at least 20"));
  test::write_png(folder_ / "flat.png", Map<float>(20, 20, 100.0F));
  EXPECT_EQ(read().error().code, ErrorCode::kImageInvalid);
  std::filesystem::remove(folder_ / "flat.png");
  ASSERT_TRUE(write_file(folder_ / "dark_0.png", "no picture"));
  EXPECT_EQ(read().error().code, ErrorCode::kImageInvalid);
}

}  // namespace
}  // namespace enamel::calib
