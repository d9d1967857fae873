#include "tools/twin/board/target_file.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "protocol/base/file.hpp"

namespace enamel::twin {
namespace {

using TargetJson = nlohmann::json;

/// A target.json while it is read; the first fault is kept.
class TargetReader {
 public:
  TargetReader(const TargetJson& json, const std::string& origin) : json_(json), origin_(origin) {}

  [[nodiscard]] Result<double> number(const char* key, double low, double high) const {
    const auto it = json_.find(key);
    if (it == json_.end() || !it->is_number()) return fault(key, "is missing or no number");
    const double value = it->get<double>();
    if (!(value >= low && value <= high)) return fault(key, "is out of range");
    return value;
  }
  [[nodiscard]] Result<int> side(const char* key) const {
    constexpr double kLeast = 3, kMost = 100;
    ENAMEL_TRY_ASSIGN(const double value, number(key, kLeast, kMost));
    if (value != std::floor(value)) return fault(key, "is no whole number from 3 to 100");
    return static_cast<int>(value);
  }
  [[nodiscard]] Result<std::string> text(const char* key) const {
    const auto it = json_.find(key);
    if (it == json_.end() || !it->is_string()) return fault(key, "is missing or no text");
    return it->get<std::string>();
  }
  [[nodiscard]] Result<std::vector<std::string>> rings(int cols, int rows) const {
    const auto it = json_.find("rings");
    const std::string want = std::to_string(rows) + " strings of " + std::to_string(cols) + " characters 0 or 1";
    if (it == json_.end() || !it->is_array() || it->size() != static_cast<std::size_t>(rows))
      return fault("rings", "must be " + want);
    std::vector<std::string> out;
    for (const TargetJson& row : *it) {
      const std::string bits = row.is_string() ? row.get<std::string>() : std::string();
      if (bits.size() != static_cast<std::size_t>(cols) || bits.find_first_not_of("01") != std::string::npos)
        return fault("rings", "row " + std::to_string(out.size()) + " is not one of " + want);
      out.push_back(bits);
    }
    return out;
  }
  [[nodiscard]] tl::unexpected<Error> fault(const std::string& key, const std::string& why) const {
    return fail(ErrorCode::kTargetFile, origin_ + ": key '" + key + "' " + why);
  }

 private:
  const TargetJson& json_;
  const std::string& origin_;
};

}  // namespace

Result<void> parse_target(std::string_view text, const std::string& origin, DotBoardConfig& board) {
  const TargetJson json = TargetJson::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return fail(ErrorCode::kTargetFile, origin + ": is no JSON object");
  const TargetReader reader(json, origin);
  ENAMEL_TRY_ASSIGN(const std::string type, reader.text("type"));
  if (type != "circle_grid" && type != "coded_dots")
    return reader.fault("type", "is neither circle_grid nor coded_dots: the twin prints no other");
  if (json.contains("circles") && json["circles"] != "white on dark")
    return reader.fault("circles", "is not 'white on dark': the twin prints no other");
  if (json.contains("marks")) return reader.fault("marks", "is not printed by the twin: use coded_dots");
  DotBoardConfig read = board;
  ENAMEL_TRY_ASSIGN(read.cols, reader.side("cols"));
  ENAMEL_TRY_ASSIGN(read.rows, reader.side("rows"));
  constexpr double kMin_mm = 0.01, kMax_mm = 100;
  ENAMEL_TRY_ASSIGN(read.pitch_mm, reader.number("pitch_mm", kMin_mm, kMax_mm));
  ENAMEL_TRY_ASSIGN(read.radius_mm, reader.number("radius_mm", kMin_mm, kMax_mm));
  if (2 * read.radius_mm >= read.pitch_mm) return reader.fault("radius_mm", "makes the dots touch");
  read.rings.clear();
  if (type == "coded_dots") {
    ENAMEL_TRY_ASSIGN(read.ring_inner_mm, reader.number("ring_inner_mm", kMin_mm, kMax_mm));
    if (read.ring_inner_mm >= read.radius_mm) return reader.fault("ring_inner_mm", "is not below radius_mm");
    ENAMEL_TRY_ASSIGN(read.rings, reader.rings(read.cols, read.rows));
  }
  board = std::move(read);
  return {};
}

Result<void> read_target(const std::string& path, DotBoardConfig& board) {
  ENAMEL_TRY_ASSIGN(const std::string text, read_file(path));
  return parse_target(text, path, board);
}

}  // namespace enamel::twin
