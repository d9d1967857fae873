// What every stage made of every burst, as digests: the run's hash, and the means to name the first stage and burst at
// which two runs part.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.hpp"
#include "protocol/base/sha256.hpp"

namespace enamel::host {

/// Stages in the order in which a burst passes them.
inline constexpr std::array<const char*, 4> kTracedStages{"input", "decode", "track", "fuse"};

struct TraceRow {
  std::uint64_t burst_id = 0;
  std::array<std::uint64_t, kTracedStages.size()> digest{};  ///< of kTracedStages, 0 = the burst did not get there
  std::string verdict;                                       ///< "fused" or the reason of rejection
};

/// One writer; rows in burst order.
class StageTrace {
 public:
  void add(TraceRow row) { rows_.push_back(std::move(row)); }
  [[nodiscard]] const std::vector<TraceRow>& rows() const noexcept { return rows_; }
  /// SHA-256 over all rows and the mesh's digest.
  [[nodiscard]] std::string hash(const std::string& mesh_digest) const;

  /// "burst_id,input,decode,track,fuse,verdict", digests in hexadecimal.
  [[nodiscard]] std::string to_csv() const;
  /// Errors: kExchangeInvalid with the line.
  [[nodiscard]] static Result<StageTrace> from_csv(const std::string& text, const std::string& path);

 private:
  std::vector<TraceRow> rows_;
};

struct TraceDifference {
  std::uint64_t burst_id = 0;
  std::string stage;  ///< of kTracedStages, "verdict", or "presence" when only one run has the burst
};

/// First burst, and in it the first stage, at which two runs differ; nullopt when they agree.
[[nodiscard]] std::optional<TraceDifference> first_difference(const StageTrace& left, const StageTrace& right);

}  // namespace enamel::host
