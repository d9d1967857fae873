// One burst as it travels: four phase-shifted frames and everything needed to interpret them.
// Plain values, mirror of enamel::v1::Burst in protocol/idl/scanner.idl; no DDS here.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/base/ids.hpp"
#include "protocol/base/time.hpp"

namespace enamel::proto {

inline constexpr int kFramesPerBurst = 4;

enum class Codec : std::uint32_t { kRaw8 = 0, kRaw10P = 1, kRaw16 = 2, kMedZstd = 3, kJpegLs = 4 };

/// Bits of FrameMeta::quality_flags. Flags inform, they never drop a burst.
enum FrameFlag : std::uint8_t {
  kFlagMotion = 1U,     ///< closure residual above 4 sigma
  kFlagSaturated = 2U,  ///< more than 5 per mille of the pixels at full scale
  kFlagLowMod = 4U,
  kFlagUnsynced = 8U,  ///< associated without trigger edges: not for accuracy tests
};

struct FrameMeta {
  std::uint32_t sensor_seq = 0;
  std::uint8_t pattern_index = 0;  ///< 0…3; 255 = dark
  std::uint8_t quality_flags = 0;
  std::uint16_t exposure_lines = 0;
  std::uint32_t exposure_us = 0;
  std::uint32_t analogue_gain_q8 = 256;
  std::uint64_t t_strobe_ns = 0;     ///< start of exposure, device clock
  std::uint64_t t_sensor_ns = 0;     ///< sensor's own stamp, device clock
  std::uint64_t t_trig_rise_ns = 0;  ///< projector lit …
  std::uint64_t t_trig_fall_ns = 0;  ///< … and dark again
  std::uint16_t mean_q4 = 0;         ///< mean grey level * 16
  std::uint16_t saturated_permille = 0;
  std::uint32_t offset = 0;  ///< of this frame in Burst::payload, bytes
  std::uint32_t length = 0;
  friend bool operator==(const FrameMeta&, const FrameMeta&) = default;
};

struct Burst {
  std::uint32_t probe_id = 0;
  std::uint32_t session_id = 0;
  std::uint64_t burst_seq = 0;    ///< counts bursts put on the wire; a gap is loss on the wire
  std::uint64_t burst_index = 0;  ///< counts bursts begun; the burst's identity everywhere else
  std::uint64_t t_first_exposure_ns = 0;
  std::uint64_t t_publish_ns = 0;
  std::uint16_t width = 0;
  std::uint16_t height = 0;
  std::uint8_t bit_depth = 8;  ///< 8, or 9…16 with two little-endian bytes a pixel
  std::uint8_t frames = kFramesPerBurst;
  Codec codec = Codec::kRaw8;
  std::uint8_t pattern_set = 0;
  std::uint32_t frame_period_ns = 0;
  std::uint32_t illum_us = 0;
  std::uint16_t led_current_code = 0;
  std::int16_t temp_centi_c = 0;
  std::uint32_t calib_crc32 = 0;    ///< CRC-32 of the bytes of the rig file in force
  std::uint32_t payload_crc32 = 0;  ///< CRC-32 of payload
  std::array<float, 3> accel_mps2{};
  std::array<float, 3> gyro_rps{};
  std::vector<FrameMeta> meta{};        ///< one a frame, in pattern order
  std::vector<std::uint8_t> payload{};  ///< rows top-down, no padding

  [[nodiscard]] BurstId id() const noexcept { return {burst_index}; }
  friend bool operator==(const Burst&, const Burst&) = default;
};

/// Middle between the start of the first and the end of the last exposure: the instant that depth and pose refer to.
/// Needs four metas.
[[nodiscard]] DeviceTime mid_burst(const Burst& burst) noexcept;

/// Mean interval between the starts of two frames, s. Needs four metas.
[[nodiscard]] double frame_period_s(const Burst& burst) noexcept;

/// Mean square distance of the light from mid-burst over all four exposures, s^2. Needs four metas.
[[nodiscard]] double exposure_spread_s2(const Burst& burst) noexcept;

/// True when sizes, codec, metas, offsets and payload CRC fit together; the first thing asked of a burst from outside.
[[nodiscard]] bool is_consistent(const Burst& burst) noexcept;

/// Pixels of frame k. Needs is_consistent(burst).
[[nodiscard]] std::span<const std::uint8_t> frame_bytes(const Burst& burst, int k) noexcept;

}  // namespace enamel::proto
