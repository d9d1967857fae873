// Internal to base: a TOML document flattened to "table.array[2].key" paths, and text back from values.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "protocol/base/result.hpp"

namespace enamel::config_detail {

/// Arrays may nest only as far as the bound types go: numbers (as double) or strings.
struct Unsupported {
  std::string what;  ///< "date", "mixed array", …
};
using Value =
    std::variant<bool, std::int64_t, double, std::string, std::vector<double>, std::vector<std::string>, Unsupported>;

struct Node {
  std::string path;
  std::string where;  ///< "file.toml:12"
  bool is_table = false;
  Value value;  ///< leaf only
};

/// In document order of lines. kConfigSyntax with file and line; also when two spellings give the same path.
[[nodiscard]] Result<std::vector<Node>> flatten_toml(std::string_view text, std::string_view name);

/// Shortest text that reads back to the same value, always recognisable as a TOML float.
[[nodiscard]] std::string float_text(double v);
[[nodiscard]] std::string float_text(float v);
[[nodiscard]] std::string string_text(std::string_view s);
[[nodiscard]] std::string_view type_name(const Value& v);

}  // namespace enamel::config_detail
