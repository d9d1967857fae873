// Internal to base: what one ConfigReader and its sub-tables share.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/base/config.hpp"
#include "protocol/base/config_toml.hpp"

namespace enamel {

struct ConfigReader::State {
  struct Bound {
    std::string path;
    std::string text;  ///< resolved value as TOML
    std::string note;  ///< doc and range
  };

  std::string name;
  std::map<std::string, config_detail::Node, std::less<>> given;
  std::vector<Bound> bound;
  std::set<std::string, std::less<>> known;         ///< paths bound so far
  std::set<std::string, std::less<>> known_arrays;  ///< paths of arrays of tables that were asked for
  std::vector<std::string> array_elements;          ///< "a[0]", "a[1]", … in the order they were asked for
  std::optional<Error> first_error;

  void add_error(const std::string& path, std::string_view why);
  /// Registers the path; the given value, or null when absent (or an error was recorded).
  const config_detail::Node* claim(const std::string& path);
  void resolved(const std::string& path, std::string text, std::string_view doc, std::string_view range);
  [[nodiscard]] std::string nearest_known(std::string_view path) const;
};

}  // namespace enamel
