// Bursts of a recording as simulated light: a recording is played through the same acquisition as real light.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "firmware/device/sim/burst_source.hpp"
#include "protocol/capture/capture.hpp"

namespace enamel::fw {

/// Reads recordings of enamel::capture. `loops` > 1 plays it again and again, numbers and times continuing.
class CaptureSource final : public BurstSource {
 public:
  /// Errors: those of CaptureReader::open; kEmptyInput; kRigForeign when its bursts name another calibration than it
  /// carries.
  [[nodiscard]] static Result<std::unique_ptr<CaptureSource>> open(const std::string& path, int loops = 1);

  [[nodiscard]] const std::string& rig_text() const override { return reader_.rig_text(); }
  [[nodiscard]] bool simulated() const override;
  [[nodiscard]] std::optional<std::uint64_t> count() const override;
  /// Damaged bursts are left out, logged and counted. Errors: kFileRead, kRigForeign.
  [[nodiscard]] Result<std::optional<SimBurst>> next() override;
  /// Bursts left out so far.
  [[nodiscard]] std::uint64_t damaged() const noexcept { return damaged_; }

 private:
  CaptureSource(capture::CaptureReader reader, std::string path, int loops);
  [[nodiscard]] Result<std::optional<proto::Burst>> next_sound();
  [[nodiscard]] SimBurst convert(const proto::Burst& burst);

  capture::CaptureReader reader_;
  std::string path_;
  std::uint32_t rig_crc32_ = 0;
  int loops_left_;
  std::uint64_t damaged_ = 0;
  std::uint64_t index_offset_ = 0;  ///< added in later rounds
  std::int64_t time_offset_ns_ = 0;
  std::uint64_t last_index_ = 0;
  std::int64_t last_start_ns_ = 0;
  std::int64_t last_distance_ns_ = 33'333'333;
  bool round_begun_ = false;
  bool any_ = false;
};

}  // namespace enamel::fw
