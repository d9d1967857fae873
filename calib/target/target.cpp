#include "calib/target/target.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "calib/model/json_object.hpp"
#include "calib/target/code_map.hpp"

namespace enamel::calib {
namespace {

constexpr int kMaxGridSide = 200;
using TypeName = std::pair<std::string_view, TargetType>;
constexpr std::array<TypeName, 3> kTypes{{{"circle_grid", TargetType::kCircleGrid},
                                          {"coded_dots", TargetType::kCodedDots},
                                          {"chessboard", TargetType::kChessboard}}};

/// Value of a key, or a fault that names it.
Result<double> number(const nlohmann::json& json, const char* key) {
  const auto it = json.find(key);
  if (it == json.end()) return fail(ErrorCode::kTargetFile, std::string("key '") + key + "' is missing");
  if (!it->is_number() || !std::isfinite(it->get<double>()))
    return fail(ErrorCode::kTargetFile, std::string("key '") + key + "' must be a finite number");
  return it->get<double>();
}

Result<int> side(const nlohmann::json& json, const char* key) {
  ENAMEL_TRY_ASSIGN(const double value, number(json, key));
  if (!(value >= 3 && value <= kMaxGridSide) || value != std::floor(value))
    return fail(ErrorCode::kTargetFile, std::string("key '") + key + "' must be a whole number from 3 to 200");
  return static_cast<int>(value);
}

Result<std::vector<GridIndex>> read_marks(const nlohmann::json& json, const TargetDesign& target) {
  std::vector<GridIndex> marks;
  if (!json.contains("marks")) return marks;
  const auto refuse = [] {
    return fail(ErrorCode::kTargetFile, "key 'marks' must be a list of [col, row] inside the grid");
  };
  if (!json["marks"].is_array()) return refuse();
  for (const auto& mark : json["marks"]) {
    if (!mark.is_array() || mark.size() != 2 || !mark[0].is_number_integer() || !mark[1].is_number_integer())
      return refuse();
    const GridIndex g{mark[0].get<int>(), mark[1].get<int>()};
    if (g.col < 0 || g.row < 0 || g.col >= target.cols || g.row >= target.rows) return refuse();
    marks.push_back(g);
  }
  return marks;
}

Result<void> read_dots(const nlohmann::json& json, TargetDesign& target) {
  ENAMEL_TRY_ASSIGN(target.radius_mm, number(json, "radius_mm"));
  if (!(target.radius_mm > 0 && target.radius_mm < 0.5 * target.pitch_mm))
    return fail(ErrorCode::kTargetFile, "key 'radius_mm' must be above 0 and below half of pitch_mm");
  const std::string circles = json.value("circles", "white on dark");
  if (circles != "white on dark" && circles != "dark on white")
    return fail(ErrorCode::kTargetFile, "key 'circles' must be 'white on dark' or 'dark on white'");
  target.is_white_on_dark = circles == "white on dark";
  ENAMEL_TRY_ASSIGN(target.marks, read_marks(json, target));
  return {};
}

/// The strings of `rings`, one a row.
Result<void> read_code(const nlohmann::json& json, TargetDesign& target) {
  ENAMEL_TRY_ASSIGN(target.ring_inner_mm, number(json, "ring_inner_mm"));
  if (!(target.ring_inner_mm > 0 && target.ring_inner_mm < target.radius_mm))
    return fail(ErrorCode::kTargetFile, "key 'ring_inner_mm' must be above 0 and below radius_mm");
  const std::string wanted = "key 'rings' must be " + std::to_string(target.rows) + " strings of " +
                             std::to_string(target.cols) + " characters 0 and 1, one a row";
  if (!json.contains("rings") || !json["rings"].is_array() ||
      json["rings"].size() != static_cast<std::size_t>(target.rows))
    return fail(ErrorCode::kTargetFile, wanted);
  for (const auto& row : json["rings"]) {
    const std::string bits = row.is_string() ? row.get<std::string>() : std::string();
    if (bits.size() != static_cast<std::size_t>(target.cols) || bits.find_first_not_of("01") != std::string::npos)
      return fail(ErrorCode::kTargetFile, wanted);
    for (const char bit : bits) target.rings.push_back(bit == '1' ? 1 : 0);
  }
  return check_code_map({target.cols, target.rows, target.rings});
}

}  // namespace

Result<TargetDesign> parse_target(std::string_view text) {
  ENAMEL_TRY_ASSIGN(const auto json, parse_json_object(text, ErrorCode::kTargetFile));
  TargetDesign target;
  const auto type = json.find("type");
  if (type == json.end() || !type->is_string()) return fail(ErrorCode::kTargetFile, "key 'type' is missing");
  const auto known = std::ranges::find(kTypes, type->get<std::string>(), &TypeName::first);
  if (known == kTypes.end())
    return fail(ErrorCode::kTargetFile, "key 'type' must be circle_grid, coded_dots or chessboard");
  if (json.contains("circles") && !json["circles"].is_string())
    return fail(ErrorCode::kTargetFile, "key 'circles' must be a string");
  target.type = known->second;
  ENAMEL_TRY_ASSIGN(target.cols, side(json, "cols"));
  ENAMEL_TRY_ASSIGN(target.rows, side(json, "rows"));
  ENAMEL_TRY_ASSIGN(target.pitch_mm, number(json, "pitch_mm"));
  if (!(target.pitch_mm > 0)) return fail(ErrorCode::kTargetFile, "key 'pitch_mm' must be positive");
  if (target.type != TargetType::kChessboard) ENAMEL_TRY(read_dots(json, target));
  if (target.type == TargetType::kCodedDots) ENAMEL_TRY(read_code(json, target));
  return target;
}

}  // namespace enamel::calib
