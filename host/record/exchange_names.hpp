// File names of an exchange folder. Private to this folder.
#pragma once

#include <cstdio>
#include <filesystem>
#include <string>

#include "host/record/exchange_folder.hpp"

namespace enamel::host {

inline constexpr const char* kRigFile = "rig.json";
inline constexpr const char* kTableFile = "bursts.csv";
inline constexpr const char* kAxesFile = "axes.csv";  ///< of the desktop scanner; as an attachment it keeps the digits
inline constexpr const char* kTableHeader = "burst_id,t0_ns,t1_ns,t2_ns,t3_ns,exposure_us,temp_c\n";

/// "frames/000012_3.png"
inline std::string frame_file(std::uint64_t burst_id, int frame) {
  std::string digits = std::to_string(burst_id);
  if (digits.size() < 6) digits.insert(0, 6 - digits.size(), '0');
  return "frames/" + digits + "_" + std::to_string(frame) + ".png";
}

/// "path:line: "
inline std::string at_line(const std::string& path, int line) {
  std::string out = path;
  out += ':';
  out += std::to_string(line);
  out += ": ";
  return out;
}

/// A name that stays inside the folder it is written to.
inline bool is_safe_relative(const std::string& name) {
  const std::filesystem::path path(name);
  if (name.empty() || name.find('\0') != std::string::npos || path.is_absolute()) return false;
  for (const auto& part : path) {
    if (part == ".." || part == "." || part.empty()) return false;
  }
  return true;
}

/// End of the last exposure: when a burst from a folder counts as logged.
inline std::int64_t row_end_ns(const ExchangeRow& row) { return row.t_ns[3] + std::int64_t{row.exposure_us} * 1000; }

}  // namespace enamel::host
