// Media types of attachments by file ending. Private to this folder.
#pragma once

#include <string>

namespace enamel::host {

inline std::string media_type_of(const std::string& name) {
  const auto has = [&](const char* ending) { return name.ends_with(ending); };
  if (has(".json")) return "application/json";
  if (has(".csv")) return "text/csv";
  if (has(".png")) return "image/png";
  if (has(".toml")) return "application/toml";
  if (has(".txt") || has(".md")) return "text/plain";
  if (has(".stl")) return "model/stl";
  return "application/octet-stream";
}

}  // namespace enamel::host
