// The measurement model's values: rig.json (format rig/1). Plain numbers only: projection lives in
// calib/model/lens.hpp. Units mm, px, rad. Pixel centres at integer coordinates for camera and projector alike.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calib/model/correction.hpp"
#include "calib/model/light_inside.hpp"
#include "calib/model/projector_response.hpp"
#include "calib/model/temperature.hpp"
#include "protocol/base/result.hpp"

namespace enamel::calib {

/// OpenCV pinhole with distortion k1 k2 p1 p2 k3. A projector is an inverse camera.
struct LensValues {
  int width = 0;
  int height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  std::array<double, 5> dist{};
};

enum class PatternMode { kPlain4, kPolarity /* "T" */, kSingle, kMicro /* "M" */, kMulti };

/// Patterns are data: phi(u_p) = 2*pi*u_p/period_px, frame k = mean + amplitude*cos(phi + k*pi/2);
/// mode T: frame 3 = mean + b(c)*amplitude*sin(phi), c = floor(phi/pi) + first_cell, b from the code taken cyclically.
struct PatternValues {
  PatternMode mode = PatternMode::kPlain4;
  bool axis_v = false;  ///< phase runs along projector v instead of u
  double period_px = 0;
  int steps = 4;
  std::vector<int> polarity_code;  ///< +1 / -1 a half fringe
  int first_cell = 0;
  int marker_fringe = 0;
  double code_ratio = 0;
  double mean = 127.5, amplitude = 120;  ///< 8-bit projector levels
};

struct NoiseValues {
  double full_well_e = 0, read_noise_e = 0, gain_e_per_dn = 0, black_dn = 0;
  int bits = 8;
};

struct DepthRange {
  double near_mm = 0, far_mm = 0;
};

struct Rig {
  LensValues camera, projector;
  std::array<std::array<double, 4>, 4> T_proj_cam{};  ///< row major, camera coordinates to projector coordinates
  PatternValues patterns;
  std::optional<DepthRange> depth_range;  ///< absent: estimated or asked for, never assumed silently
  std::optional<NoiseValues> noise;
  std::optional<ProjectorResponse> response;  ///< measured; rising, so that patterns can be made through its inverse
  std::string serial;
  std::string calibrated_at;                    ///< UTC, ISO 8601; empty for design values
  std::optional<double> temp_c;                 ///< of the probe while the calibration's pictures were taken
  std::optional<CorrectionField> correction;    ///< what the lens model leaves; lens.hpp's functions know nothing of it
  std::optional<TemperatureTerms> temperature;  ///< drift about `temp_c`; applied by rig_at()
  std::optional<LightInside> light_inside;      ///< of teeth through this probe; absent: enamel's law alone
  std::vector<std::string> unknown_keys;        ///< kept in `text`, ignored here; the caller may give notice
  std::string text;                             ///< the file byte for byte
  std::uint32_t crc32 = 0;                      ///< CRC-32 of `text`: Burst::calib_crc32
};

inline constexpr double kUsualDepthMm = 48;  ///< where a rig states no range

/// The middle of the rig's depth range: where sizes of pixels are told and motion is measured.
[[nodiscard]] inline double middle_depth_mm(const Rig& rig, double fallback_mm = kUsualDepthMm) {
  return rig.depth_range ? 0.5 * (rig.depth_range->near_mm + rig.depth_range->far_mm) : fallback_mm;
}

/// Errors: kRigInvalid (syntax, NaN or infinite numbers, missing or ill-typed key, impossible value; the detail names
/// the key), never a partial rig.
[[nodiscard]] Result<Rig> parse_rig(std::string text);

/// Errors: kFileNotFound, kFileRead and those of parse_rig.
[[nodiscard]] Result<Rig> load_rig(const std::string& path);

}  // namespace enamel::calib
