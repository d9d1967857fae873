#include "host/report/stage_trace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <sstream>

#include "protocol/base/plain_text.hpp"

namespace enamel::host {

namespace {

std::string header() {
  std::string line = "burst_id";
  for (const char* stage : kTracedStages) line += std::string(",") + stage;
  return line + ",verdict";
}

bool parse_number(const std::string& text, int base, std::uint64_t& value) {
  const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  return ec == std::errc{} && end == text.data() + text.size() && !text.empty();
}

std::optional<TraceRow> parse_row(const std::string& line) {
  std::istringstream in(line);
  TraceRow row;
  std::string field;
  if (!std::getline(in, field, ',') || !parse_number(field, 10, row.burst_id)) return std::nullopt;
  for (std::uint64_t& digest : row.digest) {
    if (!std::getline(in, field, ',') || !parse_number(field, 16, digest)) return std::nullopt;
  }
  if (!std::getline(in, row.verdict)) return std::nullopt;
  return row;
}

}  // namespace

std::string StageTrace::to_csv() const {
  std::string out = header() + "\n";
  for (const TraceRow& row : rows_) {
    out += std::to_string(row.burst_id);
    for (const std::uint64_t digest : row.digest) out += fmt::format(",{:016x}", digest);
    out += "," + row.verdict + "\n";
  }
  return out;
}

std::string StageTrace::hash(const std::string& mesh_digest) const {
  return RollingHash().update(to_csv()).update(mesh_digest).hex();
}

Result<StageTrace> StageTrace::from_csv(const std::string& text, const std::string& path) {
  std::istringstream in(plain_table(text));
  std::string line;
  if (!std::getline(in, line) || line != header())
    return fail(ErrorCode::kExchangeInvalid, path + ":1: no stage trace");
  StageTrace trace;
  for (int number = 2; std::getline(in, line); ++number) {
    auto row = parse_row(line);
    if (!row) return fail(ErrorCode::kExchangeInvalid, path + ":" + std::to_string(number));
    trace.add(std::move(*row));
  }
  return trace;
}

std::optional<TraceDifference> first_difference(const StageTrace& left, const StageTrace& right) {
  const std::size_t common = std::min(left.rows().size(), right.rows().size());
  for (std::size_t i = 0; i < common; ++i) {
    const TraceRow& a = left.rows()[i];
    const TraceRow& b = right.rows()[i];
    if (a.burst_id != b.burst_id) return TraceDifference{std::min(a.burst_id, b.burst_id), "presence"};
    for (std::size_t s = 0; s < kTracedStages.size(); ++s) {
      if (a.digest[s] != b.digest[s]) return TraceDifference{a.burst_id, kTracedStages[s]};
    }
    if (a.verdict != b.verdict) return TraceDifference{a.burst_id, "verdict"};
  }
  if (left.rows().size() == right.rows().size()) return std::nullopt;
  const auto& longer = left.rows().size() > common ? left.rows() : right.rows();
  return TraceDifference{longer[common].burst_id, "presence"};
}

}  // namespace enamel::host
