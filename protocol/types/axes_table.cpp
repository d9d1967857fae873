#include "protocol/types/axes_table.hpp"

#include <charconv>
#include <cmath>
#include <set>

#include "protocol/base/plain_text.hpp"

namespace enamel::proto {
namespace {

constexpr double kSamePlace_deg = 0.01;  // chosen: an encoder's noise is below, the smallest step of a plan far above
constexpr std::string_view kAngles = "rot_cmd_deg,swing_cmd_deg,rot_read_deg,swing_read_deg";
constexpr std::array<const char*, 4> kAngleNames{"rot_cmd_deg", "swing_cmd_deg", "rot_read_deg", "swing_read_deg"};

std::string_view key_name(AxesKey key) { return key == AxesKey::kBurst ? "burst_id" : "pose"; }

/// Empty when good, else what is wrong.
std::string read_row(std::string_view line, AxesKey key, AxesRow& row) {
  const auto fields = table_fields(line);
  if (fields.size() != 5) return std::to_string(fields.size()) + " fields, expected 5";
  row.key = fields[0];
  std::uint64_t number = 0;
  if (row.key.empty()) return std::string(key_name(key)) + " is empty";
  if (key == AxesKey::kBurst && !read_number(fields[0], number)) return "burst_id is not a whole number";
  if (key == AxesKey::kBurst) row.key = std::to_string(number);
  for (std::size_t k = 0; k < 4; ++k) {
    const std::string_view text = fields[k + 1];
    double& angle = row.angles_deg[k];
    angle = std::numeric_limits<double>::quiet_NaN();
    if (text.empty() || text == "nan" || text == "NaN") continue;
    if (!read_number(text, angle) || !std::isfinite(angle))
      return std::string(kAngleNames[k]) + " is no number; write degrees, or nan for none";
    if (std::abs(angle) > kMaxAxisAngle_deg)
      return std::string(kAngleNames[k]) + " is beyond -370 to 370 degrees; take full turns off";
  }
  for (std::size_t k = 0; k < 2; ++k) {
    if (std::isnan(row.angles_deg[k]) && std::isnan(row.angles_deg[k + 2]))
      return std::string("neither ") + kAngleNames[k] + " nor " + kAngleNames[k + 2] + " says where the axis stood";
  }
  return {};
}

void append_angle(std::string& out, double angle) {
  out += ',';
  if (std::isnan(angle)) {
    out += "nan";
    return;
  }
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), angle).ptr;
  out.append(digits.data(), end);
}

}  // namespace

Result<std::vector<AxesRow>> parse_axes_table(std::string_view text, const std::string& path, AxesKey key) {
  const ErrorCode code = key == AxesKey::kBurst ? ErrorCode::kExchangeInvalid : ErrorCode::kCalibrationFolder;
  const std::string header = std::string(key_name(key)) + "," + std::string(kAngles);
  std::vector<AxesRow> rows;
  std::set<std::string> keys;
  const std::string table = plain_table(std::string(text));
  std::string_view rest = table;
  for (int number = 1; !rest.empty(); ++number) {
    const auto invalid = [&](const std::string& what) {
      return fail(code, path + ":" + std::to_string(number) + ": " + what);
    };
    const std::string_view line = cut(rest, '\n');
    if (number == 1) {
      if (line != header) return invalid("first line must be " + header);
      continue;
    }
    AxesRow row;
    if (const std::string problem = read_row(line, key, row); !problem.empty()) return invalid(problem);
    if (!keys.insert(row.key).second) return invalid(std::string(key_name(key)) + " " + row.key + " stands twice");
    row.line = number;
    rows.push_back(std::move(row));
  }
  if (rows.empty()) return fail(code, path + ": the table holds no row");
  return rows;
}

Result<std::vector<AxesReading>> parse_burst_axes(std::string_view text, const std::string& path) {
  ENAMEL_TRY_ASSIGN(const auto rows, parse_axes_table(text, path, AxesKey::kBurst));
  std::vector<AxesReading> out;
  for (const AxesRow& row : rows) {
    AxesReading reading{.rot_cmd_deg = row.angles_deg[0],
                        .swing_cmd_deg = row.angles_deg[1],
                        .rot_read_deg = row.angles_deg[2],
                        .swing_read_deg = row.angles_deg[3]};
    static_cast<void>(read_number(std::string_view(row.key), reading.burst_index));  // read_row saw to it
    out.push_back(reading);
  }
  return out;
}

void number_stops(std::vector<AxesReading>& readings) {
  const auto place = [](double cmd, double read) { return std::isnan(cmd) ? read : cmd; };
  const auto same = [](double a, double b) { return std::abs(a - b) < kSamePlace_deg; };
  const auto stands_as = [&](const AxesReading& a, const AxesReading& b) {
    return same(place(a.rot_cmd_deg, a.rot_read_deg), place(b.rot_cmd_deg, b.rot_read_deg)) &&
           same(place(a.swing_cmd_deg, a.swing_read_deg), place(b.swing_cmd_deg, b.swing_read_deg));
  };
  std::uint32_t stop = 0;
  for (std::size_t n = 0; n < readings.size(); ++n) {
    if (n > 0 && !stands_as(readings[n - 1], readings[n])) ++stop;
    readings[n].stop = stop;
  }
}

std::string axes_table_text(const std::vector<AxesReading>& readings) {
  std::string out = "burst_id," + std::string(kAngles) + "\n";
  for (const AxesReading& r : readings) {
    out += std::to_string(r.burst_index);
    for (const double angle : {r.rot_cmd_deg, r.swing_cmd_deg, r.rot_read_deg, r.swing_read_deg})
      append_angle(out, angle);
    out += '\n';
  }
  return out;
}

}  // namespace enamel::proto
