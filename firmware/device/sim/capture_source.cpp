#include "firmware/device/sim/capture_source.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "protocol/base/crc32.hpp"
#include "protocol/base/log.hpp"

namespace enamel::fw {

CaptureSource::CaptureSource(capture::CaptureReader reader, std::string path, int loops)
    : reader_(std::move(reader)),
      path_(std::move(path)),
      rig_crc32_(crc32(std::as_bytes(std::span(reader_.rig_text())))),
      loops_left_(loops) {}

Result<std::unique_ptr<CaptureSource>> CaptureSource::open(const std::string& path, int loops) {
  ENAMEL_TRY_ASSIGN(auto reader, capture::CaptureReader::open(path));
  if (reader.info().truncated) log::warn("play", "{} is truncated: what is whole is played", path);
  if (reader.rig_text().empty()) return fail(ErrorCode::kRigMissing, path);
  if (reader.info().bursts == 0) return fail(ErrorCode::kEmptyInput, path);
  return std::unique_ptr<CaptureSource>(new CaptureSource(std::move(reader), path, loops));
}

bool CaptureSource::simulated() const {
  const capture::KeyValues& facts = reader_.info().metadata;
  return std::any_of(facts.begin(), facts.end(),
                     [](const auto& fact) { return fact.second.find("SIMULATED") != std::string::npos; });
}

std::optional<std::uint64_t> CaptureSource::count() const {
  return reader_.info().bursts * static_cast<std::uint64_t>(std::max(1, loops_left_));
}

Result<std::optional<proto::Burst>> CaptureSource::next_sound() {
  for (;;) {
    auto burst = reader_.next_burst();
    if (!burst && burst.error().code == ErrorCode::kFileRead) return burst;
    if (burst && !*burst) return burst;
    if (burst && proto::is_consistent(**burst)) return burst;
    ++damaged_;
    log::warn("play", "{}: a damaged burst is left out{}", path_, burst ? "" : ": " + burst.error().detail);
  }
}

Result<std::optional<SimBurst>> CaptureSource::next() {
  for (;;) {
    ENAMEL_TRY_ASSIGN(auto burst, next_sound());
    if (burst) {
      if (burst->calib_crc32 != 0 && burst->calib_crc32 != rig_crc32_) {
        return fail(ErrorCode::kRigForeign, path_ + ", burst " + std::to_string(burst->burst_index));
      }
      any_ = true;
      return convert(*burst);
    }
    if (--loops_left_ <= 0 || !any_) return std::optional<SimBurst>{};
    reader_.rewind();
    round_begun_ = false;
  }
}

SimBurst CaptureSource::convert(const proto::Burst& burst) {
  const auto start = static_cast<std::int64_t>(burst.meta[0].t_strobe_ns);
  // A pause in the recording, or a clock that was set on, is not waited out.
  constexpr std::int64_t kLongestPause_ns = 2'000'000'000;
  if (round_begun_ && start + time_offset_ns_ - last_start_ns_ > kLongestPause_ns) {
    time_offset_ns_ = last_start_ns_ + kLongestPause_ns - start;
  }
  if (!round_begun_ && last_start_ns_ != 0) {  // a later round goes on where the last one ended
    time_offset_ns_ = last_start_ns_ + last_distance_ns_ - start;
    index_offset_ = last_index_ + 1 - burst.burst_index;
  } else if (round_begun_ && start + time_offset_ns_ > last_start_ns_) {
    last_distance_ns_ = start + time_offset_ns_ - last_start_ns_;
  }
  round_begun_ = true;
  SimBurst out;
  out.burst_index = burst.burst_index + index_offset_;
  out.exposure_us = burst.meta[0].exposure_us;
  out.temp_c = burst.temp_centi_c / 100.0;
  out.pattern_set = burst.pattern_set;
  out.width = burst.width;
  out.height = burst.height;
  out.bit_depth = burst.bit_depth;
  for (int k = 0; k < proto::kFramesPerBurst; ++k) {
    const auto i = static_cast<std::size_t>(k);
    out.t_exposure_ns[i] = static_cast<std::int64_t>(burst.meta[i].t_strobe_ns) + time_offset_ns_;
    const auto bytes = proto::frame_bytes(burst, k);
    out.frames[i].assign(bytes.begin(), bytes.end());
  }
  last_index_ = out.burst_index;
  last_start_ns_ = out.t_exposure_ns[0];
  return out;
}

}  // namespace enamel::fw
