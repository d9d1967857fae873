// Work on recordings: compare, cut, verify.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.hpp"

namespace enamel::host {

/// Lines that tell of a damaged recording: beyond, they say nothing new.
inline constexpr std::size_t kMaxProblems = 100;

/// First difference between two recordings (or exchange folders) in log order.
struct CaptureDifference {
  std::uint64_t ordinal = 0;      ///< of the record, 0-based
  std::uint64_t burst_index = 0;  ///< when the record is a burst, shed note or reading of the axes
  std::string field;              ///< "rig", "records", "kind", "t_publish_ns", "meta[2].t_strobe_ns", "payload" …
  std::string left, right;        ///< values; for pixels frame, column, row and value
};

/// nullopt when equal: rig and every field of every record. Log times are compared only on request.
[[nodiscard]] Result<std::optional<CaptureDifference>> capture_diff(const std::string& left, const std::string& right,
                                                                    bool with_log_times = false);

struct CopySummary {
  std::uint64_t bursts = 0;             ///< copied
  std::uint64_t missing = 0;            ///< bursts that were in damaged places of the source
  std::vector<std::string> problems{};  ///< what is damaged there, one line each, at most 100
};

/// Copies bursts [first, last] by burst_index, what else was logged from the first to the last of them, and all
/// attachments, byte for byte; of the angles of axes those of the bursts. A truncated or damaged source gives a clean
/// file of what is whole. On error no file is left behind. Errors: kBurstNotFound when the range is empty.
[[nodiscard]] Result<CopySummary> capture_cut(const std::string& in, const std::string& out, std::uint64_t first,
                                              std::uint64_t last);

/// Copies every record and attachment that is whole. Errors: kEmptyInput when no burst is.
[[nodiscard]] Result<CopySummary> capture_repair(const std::string& in, const std::string& out);

struct VerifyReport {
  std::uint64_t bursts = 0;  ///< readable and consistent
  std::uint64_t records = 0;
  bool truncated = false;
  std::vector<std::string> problems;  ///< one line each, at most 100
  [[nodiscard]] bool clean() const noexcept { return problems.empty() && !truncated; }
};

/// Reads everything once: chunk and attachment CRCs, message decoding, burst consistency and payload CRC, rig CRC,
/// order, angles of the axes against axes.csv. Errors only when the file cannot be opened at all.
[[nodiscard]] Result<VerifyReport> capture_verify(const std::string& path);

}  // namespace enamel::host
