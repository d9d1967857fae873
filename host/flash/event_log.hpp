// Log of an update for machines: JSON lines {ts, serial, event, block, status}.
#pragma once

#include <fstream>
#include <string>

#include "host/update/flash_flow.hpp"

namespace enamel::flash_app {

/// Not thread-safe: one caller at a time.
class EventLog {
 public:
  /// Appends to `path` and drops lines that are older than 30 days. An empty path: nothing is logged.
  [[nodiscard]] static update::Updated<EventLog> open(const std::string& path);

  /// The line is handed to the system before this returns: what was logged survives the tool.
  void write(const update::PortInfo& probe, const update::FlashEvent& event);

 private:
  std::ofstream out_;
};

}  // namespace enamel::flash_app
