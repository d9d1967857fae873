#include "calib/target/target.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "calib/model/json_object.hpp"

namespace enamel::calib {
namespace {

constexpr int kMaxGridSide = 200;

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

}  // namespace

Result<TargetDesign> parse_target(std::string_view text) {
  ENAMEL_TRY_ASSIGN(const auto json, parse_json_object(text, ErrorCode::kTargetFile));
  TargetDesign target;
  const auto type = json.find("type");
  if (type == json.end() || !type->is_string()) return fail(ErrorCode::kTargetFile, "key 'type' is missing");
  if (*type != "circle_grid" && *type != "chessboard")
    return fail(ErrorCode::kTargetFile, "key 'type' must be circle_grid or chessboard");
  if (json.contains("circles") && !json["circles"].is_string())
    return fail(ErrorCode::kTargetFile, "key 'circles' must be a string");
  target.type = *type == "chessboard" ? TargetType::kChessboard : TargetType::kCircleGrid;
  ENAMEL_TRY_ASSIGN(target.cols, side(json, "cols"));
  ENAMEL_TRY_ASSIGN(target.rows, side(json, "rows"));
  ENAMEL_TRY_ASSIGN(target.pitch_mm, number(json, "pitch_mm"));
  if (!(target.pitch_mm > 0)) return fail(ErrorCode::kTargetFile, "key 'pitch_mm' must be positive");
  if (target.type == TargetType::kCircleGrid) ENAMEL_TRY(read_dots(json, target));
  return target;
}

}  // namespace enamel::calib
