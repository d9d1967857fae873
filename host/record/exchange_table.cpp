// bursts.csv
#include <array>
#include <cmath>
#include <string_view>

#include "host/record/exchange_folder.hpp"
#include "host/record/exchange_names.hpp"
#include "protocol/base/plain_text.hpp"

namespace enamel::host {
namespace {

constexpr std::string_view kColumns = "burst_id,t0_ns,t1_ns,t2_ns,t3_ns,exposure_us,temp_c";
constexpr std::size_t kFields = 7;
constexpr std::array<const char*, 4> kTimeNames{"t0_ns", "t1_ns", "t2_ns", "t3_ns"};
constexpr std::int64_t kMaxTimeNs = std::int64_t{1} << 61U;

// Empty when good, else what is wrong.
std::string parse_row(std::string_view line, ExchangeRow& row) {
  const auto fields = table_fields(line);
  if (fields.size() != kFields) return std::to_string(fields.size()) + " fields, expected 7";
  if (!read_number(fields[0], row.burst_id)) return "burst_id is not a whole number";
  for (std::size_t k = 0; k < 4; ++k) {
    const std::string name = kTimeNames[k];
    if (!read_number(fields[k + 1], row.t_ns[k])) return name + " is not a whole number";
    if (row.t_ns[k] < 0 || row.t_ns[k] > kMaxTimeNs) return name + " is out of range";
    if (k > 0 && row.t_ns[k] <= row.t_ns[k - 1]) return name + " is not after the frame before";
  }
  double exposure = 0;
  if (!read_number(fields[5], exposure) || !(exposure >= 0 && exposure <= 1e9))
    return "exposure_us is not a usable number";
  row.exposure_us = static_cast<std::uint32_t>(std::lround(exposure));
  if (!read_number(fields[6], row.temp_c) || !(std::abs(row.temp_c) < 300)) return "temp_c is not a usable number";
  return {};
}

}  // namespace

Result<std::vector<ExchangeRow>> parse_bursts_csv(const std::string& text, const std::string& path) {
  std::vector<ExchangeRow> rows;
  const std::string table = plain_table(text);
  std::string_view rest = table;
  for (int number = 1; !rest.empty(); ++number) {
    const auto invalid = [&](const std::string& what) {
      return fail(ErrorCode::kExchangeInvalid, at_line(path, number) + what);
    };
    const std::string_view line = cut(rest, '\n');
    if (number == 1) {
      if (line != kColumns) return invalid("first line must be " + std::string(kColumns));
      continue;
    }
    ExchangeRow row;
    if (const std::string problem = parse_row(line, row); !problem.empty()) return invalid(problem);
    if (!rows.empty() && row.burst_id <= rows.back().burst_id) return invalid("burst_id does not ascend");
    row.text = line;
    row.line = number;
    rows.push_back(std::move(row));
  }
  if (table.empty()) return fail(ErrorCode::kExchangeInvalid, path + ":1: the file is empty");
  return rows;
}

}  // namespace enamel::host
